// The planner over the real wasm module: the same plans as every other build, and refusals.

import { readFileSync } from "node:fs";
import { beforeAll, expect, test } from "vitest";
import type { Progress, Reply, Request, ViewSpace } from "../src/messages.js";
import { Planner } from "../src/planner.js";
import { load } from "vantage-wasm";

beforeAll(async () => {
  await load();
});

const sphere: ViewSpace = { kind: "fibonacci-sphere" };

function begin(planner: Planner, change: Partial<Extract<Request, { type: "start" }>> = {}): Reply[] {
  const plan = { scheme: "farthest-point", budget: 10, seed: 5 } as const;
  return planner.answer({ type: "start", run: 1, space: sphere, count: 48, radiusM: 1.5, plan, ...change });
}

function progress(replies: Reply[]): Progress {
  const last = replies.at(-1);
  if (last?.type !== "progress") throw new Error(`no progress: ${JSON.stringify(last)}`);
  return last.progress;
}

/** The choices under a heading of the text that every build must write, and what became of them. */
function golden(heading: string): { index: number; mark: string }[] {
  const path = new URL("../../tests/same-plan/golden/plans.txt", import.meta.url);
  const lines = readFileSync(path, "utf8").split("\n");
  const begin = lines.indexOf(heading);
  expect(begin, heading).toBeGreaterThan(-1);
  const choices = [];
  for (const line of lines.slice(begin + 1)) {
    const match = /^ {2}(\d+) [0-9a-f]{8}( \w+)?$/.exec(line);
    if (match === null) break;
    choices.push({ index: Number(match[1]), mark: match[2]?.trim() ?? "taken" });
  }
  return choices;
}

test.each([
  ["random", "random, fibonacci sphere", 5],
  ["farthest-point", "farthest point, fibonacci sphere", 5],
  ["pseudo-coverage", "pseudo-coverage, fibonacci sphere", 0],
] as const)("%s gives the plan of every other build", (scheme, heading, seed) => {
  const planner = new Planner();
  let state = progress(begin(planner, { plan: { scheme, budget: 10, seed } }));
  const choices = golden(heading);
  expect(choices).toHaveLength(12);
  for (const { index, mark } of choices) {
    expect(state.next?.index).toBe(index);
    const type = mark === "blocked" ? "block" : mark === "skipped" ? "skip" : "take";
    state = progress(planner.answer({ type, run: 1, index }));
  }
  expect(state.next).toBeNull();
  expect(state.finish).toBe("budget-spent");
});

test("a refusal has a code and a sentence, and changes nothing", () => {
  const planner = new Planner();
  const before = progress(begin(planner));
  const refuse = (reply: Reply[], code: string): void => {
    expect(reply).toHaveLength(1);
    expect(reply[0]).toMatchObject({ type: "refused", code });
  };
  refuse(begin(planner, { plan: { scheme: "random", budget: 49 } }), "bad-plan");
  refuse(begin(planner, { plan: { scheme: "random", budget: 0 } }), "bad-plan");
  refuse(begin(planner, { count: -1 }), "bad-argument");
  refuse(begin(planner, { count: Number.NaN }), "bad-argument");
  refuse(begin(planner, { count: 0 }), "bad-pool");
  refuse(begin(planner, { radiusM: Number.NaN }), "bad-pool");
  refuse(planner.answer({ type: "take", run: 1, index: 48 }), "unknown-candidate");
  refuse(planner.answer({ type: "take", run: 1, index: 0.5 }), "bad-argument");
  refuse(planner.answer({ type: "restore", run: 1, snapshot: new Uint8Array(3) }), "bad-snapshot");
  const after = progress(planner.answer({ type: "unblock", run: 1, index: 0 }));
  expect(after.next).toEqual(before.next);
  expect(after.views).toEqual([]);
});

test("without a plan there is nothing to take", () => {
  const reply = new Planner().answer({ type: "take", run: 3, index: 0 });
  expect(reply).toMatchObject([{ type: "refused", run: 3, code: "no-session" }]);
});

test("a restored session goes on to the same plan", () => {
  const first = new Planner();
  let state = progress(begin(first, { plan: { scheme: "random", budget: 10, seed: 9 } }));
  for (let step = 0; step < 4; step++) {
    state = progress(first.answer({ type: "take", run: 1, index: state.next?.index ?? -1 }));
  }
  const second = new Planner();
  const restored = second.answer({ type: "restore", run: 2, snapshot: state.snapshot });
  expect(restored[0]).toMatchObject({ type: "started", run: 2, budget: 10 });
  const ends = [first, second].map((planner) => progress(planner.answer({ type: "take-all", run: 2 })));
  expect(ends[1]?.views).toEqual(ends[0]?.views);
  expect(ends[0]?.views).toHaveLength(10);
});

test("a damaged snapshot is refused, whichever byte it is", () => {
  const { snapshot } = progress(begin(new Planner(), { count: 6, plan: { scheme: "random", budget: 2 } }));
  for (let byte = 0; byte < snapshot.length; byte++) {
    const damaged = snapshot.slice();
    damaged[byte] = (damaged[byte] ?? 0) ^ 0x10;
    const [reply] = new Planner().answer({ type: "restore", run: 1, snapshot: damaged });
    expect(reply?.type, `byte ${byte}`).toBe("refused");
  }
});

test("every pose looks at the origin from its distance", () => {
  const [started] = begin(new Planner());
  if (started?.type !== "started") throw new Error("no plan");
  expect(started.poses).toHaveLength(48 * 12);
  for (let at = 0; at < started.poses.length; at += 12) {
    const column = (c: number): number[] => [0, 1, 2].map((row) => started.poses[at + 4 * row + c] ?? NaN);
    const [back, eye] = [column(2), column(3)];
    expect(Math.hypot(...eye)).toBeCloseTo(1.5, 5);
    back.forEach((value, axis) => expect(value * 1.5).toBeCloseTo(eye[axis] ?? NaN, 5));
  }
});
