// What the classes give, as JavaScript sees it.

import { deepEqual, equal, ok } from "node:assert/strict";
import { test } from "node:test";

import { pool, poseNetwork, rest, seeing, session, vantage } from "./package.mjs";

const { MeshLedger, Pool, Session } = vantage;
const OBJECTIVES = ["coverage", "geometry", "diversity", "texture"];

test("a next view says where, why and how much", () => {
  const begun = session();
  const { index, pose, why, ...first } = begun.nextView();
  deepEqual(first, { gain: 0, reason: "start" });
  deepEqual(pose, pool().poses().slice(12 * index, 12 * index + 12));
  equal(why, "first look");
  for (let photo = 0; photo < 3; photo++) begun.observe(begun.nextView().index);

  const next = begun.nextView();
  deepEqual(Object.keys(next).sort(), ["gain", "index", "objective", "pose", "reason", "why"]);
  deepEqual([next.objective, next.reason, next.why], ["coverage", "coverage", "most new surface expected"]);
  equal(begun.gains("coverage")[next.index], next.gain);
  equal(begun.progress().gainLeft.coverage, next.gain);
  deepEqual(begun.nextView(), next);

  begun.replan({ scheme: "sum", budget: 12 });
  const { objective, reason } = begun.nextView();
  deepEqual([objective, reason], [undefined, "all-objectives"]);
  begun.replan({ scheme: "random", budget: 12 });
  equal(begun.nextView().reason, "chance");
  begun.replan({ scheme: "farthest-point", budget: 12 });
  ok(begun.nextView().reason === "farthest" && begun.nextView().gain > 0);
});

test("progress knows what it can know", () => {
  const blind = new Session(pool(), { scheme: "random", budget: 2 });
  blind.observe(3);
  for (const [begun, hasModel] of [[blind, false], [session(), true]]) {
    equal(begun.hasModel, hasModel);
    const { views, isEnough, ...known } = begun.progress();
    deepEqual([views, isEnough, known], [hasModel ? 0 : 1, false, { budget: begun.budget }]);
    ok(begun.gains("texture").every(Number.isNaN));
  }
  const begun = session({ budget: 40, stop: { gain: 1, patience: 2 } }, 4);
  const { scores, gainLeft, isEnough } = begun.progress();
  deepEqual([Object.keys(scores), Object.keys(gainLeft), isEnough], [OBJECTIVES, OBJECTIVES, false]);
  ok(OBJECTIVES.every((objective) => scores[objective] >= 0 && scores[objective] <= 1));
  rest(begun);
  deepEqual([begun.progress().isEnough, begun.finish(), begun.progress().views], [true, "good-enough", 5]);
  // A budget that is spent is no verdict.
  const spent = session({ budget: 3 }, 3);
  deepEqual([spent.progress().isEnough, spent.finish()], [false, "budget-spent"]);
});

test("candidates change their status", () => {
  const begun = session();
  begun.observe(5);
  begun.block(6);
  begun.skip(7);
  const statuses = begun.statuses();
  deepEqual(statuses.slice(5, 9), ["visited", "blocked", "skipped", "available"]);
  deepEqual([6, 7].map((index) => begun.gains("coverage")[index]), [NaN, NaN]);
  begun.unblock(6);
  begun.observe(0);
  ok(begun.statuses().slice(6, 9).every((status) => status === "available"));
  for (let index = 0; index < 40; index++) begun.block(index);
  deepEqual([begun.nextView(), begun.finish()], [undefined, "nothing-left"]);
  deepEqual(begun.progress().gainLeft, { coverage: 0, geometry: 0, diversity: 0, texture: 0 });
});

test("photos count where they were really taken", () => {
  const begun = session({}, 2);
  const pose = new Pool({ kind: "random-sphere", seed: 3 }, 1, 2.5).poses();
  begun.observe(begun.nextView().index, undefined, pose);
  begun.observeElsewhere(pose);
  equal(begun.views().length, 3);
  equal(begun.progress().views, 4);
  for (const view of [2, 3]) {
    ok(begun.viewPoses().slice(12 * view, 12 * view + 12).every((value, at) => Math.abs(value - pose[at]) < 1e-5));
  }
});

test("what a photo shows and which square of it counts", () => {
  const [WIDTH, HEIGHT] = [90, 70];
  const scoresOf = (change) => {
    const pixels = Uint8Array.from({ length: WIDTH * HEIGHT * 3 }, (_, at) => (at * at * 7) % 256);
    const begun = new Session(pool(), { scheme: "ensemble", budget: 3 }, seeing);
    begun.observe(0, { pixels, width: WIDTH, height: HEIGHT, format: "rgb", ...change });
    return begun.progress().scores;
  };
  const usual = scoresOf({});
  deepEqual(scoresOf({ window: { left: 10, top: 0, side: 70 } }), usual);
  deepEqual(scoresOf({ window: undefined }), usual);
  const others = [
    { window: { left: -20, top: 5, side: 40 } },
    { pixels: new Uint8Array(WIDTH * HEIGHT).fill(200), format: "luma" },
  ];
  for (const other of others) ok(scoresOf(other).coverage !== usual.coverage);
});

test("a pool stands around its centre, and so does its plan", () => {
  const centre = [1, -2, 0.5];
  const around = new Pool({ kind: "fibonacci-sphere" }, 20, 3, centre);
  const poses = around.poses();
  for (let index = 0; index < around.length; index++) {
    const away = [3, 7, 11].map((at, axis) => poses[12 * index + at] - centre[axis]);
    ok(Math.abs(Math.hypot(...away) - 3) < 1e-5);
  }
  // The same object elsewhere: the same plan, to rounding.
  const plan = { scheme: "diversity", budget: 8 };
  const here = new Session(new Pool({ kind: "fibonacci-sphere" }, 20, 3), plan, poseNetwork);
  const there = new Session(Pool.fromPoses(poses, centre), plan, poseNetwork);
  deepEqual(rest(there), rest(here));
});

test("exact scores of a mesh", () => {
  // A tetrahedron: three right triangles of area 1/2 and one of √3/2.
  const positions = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1);
  const ledger = new MeshLedger(positions, Uint32Array.of(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3));
  deepEqual(ledger.scores(), { coverage: 0, diversity: 0 });
  const poses = pool().poses();
  ledger.observe(poses.subarray(0, 12), Uint32Array.of(0, 1, 1, 2));
  ok(Math.abs(ledger.scores().coverage - 1 / (1.5 + Math.sqrt(0.75))) < 1e-6);
  for (let view = 1; view < 9; view++) {
    ledger.observe(poses.subarray(12 * view, 12 * view + 12), Uint32Array.of(1, 2, 3, 4));
  }
  const { coverage, diversity } = ledger.scores();
  equal(coverage, 1);
  ok(diversity > 0 && diversity < 1);
});
