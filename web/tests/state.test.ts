// The page's logic without a page.

import { expect, test } from "vitest";
import { dots, project } from "../src/dome.js";
import { order } from "../src/form.js";
import type { Progress } from "../src/messages.js";
import { type State, direction, guidance, initial, next } from "../src/state.js";
import { fromText, toText } from "../src/storage.js";
import { transforms } from "../src/transforms.js";

/** A pose at a place; its rotation does not matter here. */
const at = (x: number, y: number, z: number): number[] => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z];

const progress: Progress = {
  statuses: ["visited", "available", "blocked"],
  views: [0],
  viewPoses: new Float32Array(at(1, 0, 0)),
  next: { index: 1, pose: new Float32Array(at(0, -1, 1)), gain: 1, reason: "farthest", why: "it is far" },
  finish: null,
  tour: { order: [0], lengthRad: 0 },
  snapshot: new Uint8Array(),
};
const planned: State = {
  ...initial,
  run: 2,
  poses: new Float32Array([...at(1, 0, 0), ...at(0, -1, 1), ...at(0, 0, 1)]),
  budget: 3,
  progress,
};

test("an answer to an abandoned plan changes nothing", () => {
  const reply = { type: "refused", run: 1, code: "bad-plan", message: "no" } as const;
  expect(next(planned, { type: "replied", reply })).toBe(planned);
});

test("a refusal is shown and ends the waiting; asking again clears it", () => {
  const reply = { type: "refused", run: 2, code: "bad-plan", message: "no" } as const;
  const refused = next(next(planned, { type: "asked" }), { type: "replied", reply });
  expect(refused).toMatchObject({ error: "no", waiting: false, progress });
  expect(next(refused, { type: "asked" })).toMatchObject({ error: null, waiting: true });
  expect(next(refused, { type: "asked-anew" })).toMatchObject({ run: 3, error: null });
});

test("the dome turns all the way round but not over", () => {
  const up = next(planned, { type: "turned", azimuthRad: 9, elevationRad: 9 });
  expect(up.camera.elevationRad).toBe(Math.PI / 2);
  expect(Math.abs(up.camera.azimuthRad)).toBeLessThan(2 * Math.PI);
});

test("guidance says where and why, or why not", () => {
  expect(guidance(planned)).toBe("View 1: 270° around, 45° above the horizon. Why: it is far.");
  const done = { ...planned, progress: { ...progress, next: null, finish: "nothing-left" as const } };
  expect(guidance(done)).toContain("out of reach");
  expect(guidance(initial)).toBe("Preparing…");
});

test("directions are degrees around from +X and above the horizon", () => {
  expect(direction(at(0, 2, 0))).toEqual({ azimuthDeg: 90, elevationDeg: 0 });
  expect(direction(at(0, 0, -1)).elevationDeg).toBe(-90);
});

test("seen from +X, +Y is to the right and +Z up", () => {
  const camera = { azimuthRad: 0, elevationRad: 0 };
  expect(project([0, 1, 0], camera)).toMatchObject({ x: 1 });
  expect(project([0, 0, 1], camera).y).toBe(-1);
  expect(project([1, 0, 0], camera).depth).toBe(1);
  const above = { azimuthRad: 0, elevationRad: Math.PI / 2 };
  expect(project([0, 0, 1], above).depth).toBeCloseTo(1);
  expect(project([1, 0, 0], above).y).toBeCloseTo(1);
});

test("the nearest dots are drawn last, and the next view on top of all", () => {
  const drawn = dots({ ...planned, camera: { azimuthRad: 0, elevationRad: 0 } });
  expect(drawn.map((dot) => dot.mark)).toEqual(["blocked", "visited", "next"]);
});

test("fields become a plan in radians and metres", () => {
  const fields: Record<string, string> = {
    space: "rings", count: "60", radiusM: "0.5", scheme: "random", budget: "9", seed: "4",
  };
  const asked = order((name) => fields[name] ?? "");
  expect(asked).toMatchObject({ count: 60, radiusM: 0.5, plan: { scheme: "random", budget: 9, seed: 4 } });
  expect(asked.space).toMatchObject({ kind: "rings", rings: 3 });
  expect(order(() => "").count).toBeNaN();
});

test("transforms.json has a 4 x 4 matrix and a name for each photo, in order", () => {
  const { frames } = transforms(new Float32Array([...at(1, 2, 3), ...at(4, 5, 6)]));
  expect(frames.map((frame) => frame.file_path)).toEqual(["images/0001.jpg", "images/0002.jpg"]);
  expect(frames[1]?.transform_matrix).toEqual([[1, 0, 0, 4], [0, 1, 0, 5], [0, 0, 1, 6], [0, 0, 0, 1]]);
});

test("bytes survive the way through text", () => {
  const bytes = Uint8Array.from({ length: 256 }, (_, value) => value);
  expect(fromText(toText(bytes))).toEqual(bytes);
});
