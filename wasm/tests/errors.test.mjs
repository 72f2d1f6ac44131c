// Every code that the package can refuse with, provoked; and what a refusal leaves behind.

import { deepEqual, equal, ok } from "node:assert/strict";
import { test } from "node:test";
import { crc32 } from "node:zlib";

import { file, pool, poseNetwork, rest, seeing, session, thrown, vantage } from "./package.mjs";

const { MeshLedger, Model, Pool, Session } = vantage;

const space = { kind: "hemisphere", minElevationRad: 0, maxElevationRad: 1 };
const poses = pool().poses();
const pose = poses.subarray(0, 12);
const model = file("wasm/pkg/soarnet-poses.model");
const triangle = [new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), Uint32Array.of(0, 1, 2)];
const photo = { pixels: new Uint8Array(48), width: 4, height: 4, format: "rgb" };
const plan = { scheme: "ensemble", budget: 12 };

/** Bytes with one of them changed. */
const changed = (bytes, at) => Uint8Array.from(bytes, (byte, index) => byte ^ (index === at));

/** A session of a network that sees photos. */
const withPhotos = () => new Session(pool(), plan, seeing);

// A few ways to each code; between them every argument of every call.
const REFUSALS = {
  "bad-argument": [
    () => new Pool(undefined, 9, 1),
    () => new Pool({ kind: "ring" }, 9, 1),
    () => new Pool({ kind: "random-sphere", seed: 0.5 }, 9, 1),
    () => new Pool({ kind: "hemisphere", minElevationRad: 0 }, 9, 1),
    () => new Pool(space, -1, 1),
    () => new Pool(space, 1.5, 1),
    () => new Pool(space, 2 ** 32, 1),
    () => new Pool(space, 9, 1, [0, 1]),
    () => new Pool(space, 9, 1, null),
    () => Pool.fromPoses([...poses]),
    () => new Model("soarnet.model"),
    () => new Model({ length: 2 ** 40 }),
    () => session({ scheme: "best" }),
    () => session({ scheme: undefined }),
    () => session({ budget: "12" }),
    () => session({ budget: NaN }),
    () => session({ seed: -1 }),
    () => session({ movementCost: null }),
    () => session({ opposite: "half" }),
    () => session({ stop: {} }),
    () => session({ stop: { gain: 0.1, patience: 70000 } }),
    () => session({ start: "north" }),
    () => session({ startViews: 0.1 }),
    () => session({ centre: ["0", "0", "0"] }),
    () => new Session(pool(), plan, {}),
    () => new Session(pool(), plan, null),
    () => new Session(pool(), plan, pool()),
    () => session().observe(-1),
    () => session().observe(0.5),
    () => session().observe(undefined),
    () => session().observe(0, undefined, pose.subarray(1)),
    () => session().observe(0, undefined, [...pose]),
    () => session().observe(0, 7),
    () => session().observe(0, { ...photo, format: "hsv" }),
    () => session().observe(0, { ...photo, width: -4 }),
    () => session().observe(0, { ...photo, pixels: [1, 2, 3] }),
    () => session().observe(0, { ...photo, window: {} }),
    () => session().observe(0, { ...photo, window: { left: 0.5, top: 0, side: 1 } }),
    () => session().observe(0, { ...photo, window: { left: 2 ** 31, top: 0, side: 1 } }),
    () => session().observeElsewhere(undefined),
    () => session().block(NaN),
    () => session().gains("beauty"),
    () => session().tour([1, 2]),
    () => session().replan(undefined),
    () => Session.restore("bytes"),
    () => new MeshLedger([], []),
    () => new MeshLedger(...triangle).observe(pose, Uint32Array.of(2)),
    () => new MeshLedger(...triangle).observe(pose, [1]),
  ],
  "bad-pool": [
    () => new Pool(space, 0, 1),
    () => new Pool(space, 9, 0),
    () => new Pool(space, 9, NaN),
    () => new Pool(space, 9, 1, [1e300, 0, 0]),
    () => new Pool({ ...space, minElevationRad: 1.1 }, 9, 1),
    () => new Pool({ ...space, kind: "rings", rings: 10 }, 9, 1),
    () => Pool.fromPoses(poses.subarray(1)),
    () => Pool.fromPoses(new Float32Array()),
    () => Pool.fromPoses(poses, [NaN, 0, 0]),
  ],
  "bad-plan": [
    () => session({ budget: 0 }),
    () => session({ budget: 41 }),
    () => session({ movementCost: 1.5 }),
    () => session({ opposite: 1.5 }),
    () => session({ stop: { gain: -1, patience: 1 } }),
    () => session({ scheme: "random", stop: { gain: 0.1, patience: 1 } }),
    () => session({ centre: [0, Infinity, 0] }),
    () => session().replan({ ...plan, budget: 0 }),
  ],
  "bad-pose": [
    () => Pool.fromPoses(new Float32Array(12)),
    () => session({ centre: [poses[3], poses[7], poses[11]] }),
    () => session().observe(0, undefined, new Float32Array(12).fill(NaN)),
    () => session().observeElsewhere(Float32Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)),
    () => new MeshLedger(...triangle).observe(new Float32Array(12), Uint32Array.of(1)),
  ],
  "bad-photo": [
    () => session().observe(0, { ...photo, width: 5 }),
    () => session().observe(0, { ...photo, format: "rgba" }),
    () => session().observe(0, { ...photo, format: "luma" }),
    () => session().observe(0, { ...photo, width: 0, pixels: new Uint8Array() }),
    () => session().observe(0, { ...photo, window: { left: 0, top: 0, side: 0 } }),
    () => session().observe(0, { ...photo, window: { left: 0, top: 0, side: 32769 } }),
  ],
  "bad-model": [
    () => new Model(new Uint8Array()),
    () => new Model(model.subarray(0, 2000)),
    () => new Model(changed(model, 1000)),
  ],
  "bad-mesh": [
    () => new MeshLedger(new Float32Array(9), Uint32Array.of(0, 1, 2)),
    () => new MeshLedger(triangle[0], Uint32Array.of(0, 1)),
    () => new MeshLedger(triangle[0], Uint32Array.of(0, 1, 3)),
    () => new MeshLedger(triangle[0].subarray(1), Uint32Array.of(0, 1, 2)),
  ],
  "needs-model": [
    () => new Session(pool(), plan),
    () => new Session(pool(), { scheme: "random", budget: 3 }).replan(plan),
    () => Session.restore(session().snapshot()),
  ],
  "needs-photo": [
    () => withPhotos().observe(0),
    () => withPhotos().observeElsewhere(pose),
  ],
  "unknown-candidate": [
    () => session().observe(40),
    () => session().block(2 ** 32 - 1),
    () => session().unblock(40),
    () => session().skip(40),
    () => session().tour(Uint32Array.of(0, 40)),
  ],
  "too-large": [
    () => session().tour(new Uint32Array(1025)),
    () => Pool.fromPoses(new Float32Array(12 * 65537)),
    () => new Session(pool(300), { ...plan, budget: 257 }, poseNetwork),
    () => new MeshLedger(triangle[0], new Uint32Array(3 * (2 ** 21 + 1))),
  ],
  "bad-snapshot": [
    () => Session.restore(new Uint8Array()),
    () => Session.restore(new TextEncoder().encode("not a snapshot"), poseNetwork),
    () => Session.restore(session({}, 3).snapshot().subarray(0, -1), poseNetwork),
    () => Session.restore(changed(session({}, 3).snapshot(), 99), poseNetwork),
  ],
  "other-version": [() => Session.restore(changed(session().snapshot(), 4), poseNetwork)],
  "other-model": [() => Session.restore(session().snapshot(), seeing)],
};

test("each code is refused with", () => {
  for (const [code, calls] of Object.entries(REFUSALS)) {
    for (const call of calls) {
      const error = thrown(call);
      ok(error instanceof Error, `${call} throws`);
      equal(error.code, code, `${call}: ${error.message}`);
      ok(error.message.length > 10, error.message);
    }
  }
});

test("the codes are those of the types", () => {
  const types = file("wasm/pkg/vantage_wasm.d.ts").toString();
  const union = /export type RefusalCode =([^;]*);/.exec(types)[1];
  deepEqual([...union.matchAll(/"([^"]+)"/g)].map(([, code]) => code).sort(), Object.keys(REFUSALS).sort());
});

test("a refusal changes nothing", () => {
  const [tried, untouched] = [session({}, 4), session({}, 4)];
  for (const call of [
    () => tried.observe(0, { ...photo, format: "rgba" }),
    () => tried.observe(40),
    () => tried.observe(0, undefined, new Float32Array(12)),
    () => tried.block(40),
    () => tried.replan({ ...plan, budget: 0 }),
    () => tried.gains("beauty"),
    () => tried.tour(Uint32Array.of(99)),
  ]) {
    ok(thrown(call));
  }
  deepEqual(tried.snapshot(), untouched.snapshot());
  deepEqual(rest(tried), rest(untouched));
});

test("a snapshot with any one byte changed is refused", () => {
  const kept = session({}, 2).snapshot();
  for (let at = 0; at < kept.length; at++) {
    const code = thrown(() => Session.restore(changed(kept, at), poseNetwork))?.code;
    ok(["bad-snapshot", "other-version"].includes(code), `byte ${at}: ${code}`);
  }
});

test("snapshots and models whose checksum is right but whose numbers are not do no harm", () => {
  // A generator of its own, so that every run sees the same.
  let state = 1;
  const chance = (bound) => ((state = (Math.imul(state, 1664525) + 1013904223) >>> 0) >>> 8) % bound;
  const forged = (bytes) => {
    const copy = Uint8Array.from(bytes);
    for (let change = chance(4); change >= 0; change--) {
      copy[4 + chance(copy.length - 8)] = chance(256);
    }
    new DataView(copy.buffer).setUint32(copy.length - 4, crc32(copy.subarray(0, -4)), true);
    return copy;
  };
  const outcomes = { refused: 0, used: 0 };
  const attempt = (use) => {
    const error = thrown(use);
    if (error) ok(typeof error.code === "string", String(error));
    outcomes[error ? "refused" : "used"]++;
  };
  const kept = [session({ stop: { gain: 0.1, patience: 9 } }, 5).snapshot(), session({}, 0).snapshot()];
  const blind = new Session(pool(), { scheme: "random", budget: 9 });
  rest(blind);
  for (let turn = 0; turn < 900; turn++) {
    attempt(() => {
      const again = Session.restore(forged([...kept, blind.snapshot()][turn % 3]), poseNetwork);
      again.progress();
      again.gains("texture");
      again.nextView();
      again.observe(0);
      again.tour(Uint32Array.of(0, 5, 2));
      Session.restore(again.snapshot(), poseNetwork).free();
      again.free();
    });
  }
  ok(outcomes.used > 100 && outcomes.refused > 100, JSON.stringify(outcomes));
  for (let turn = 0; turn < 60; turn++) {
    attempt(() => {
      const network = new Model(forged(model));
      const begun = new Session(pool(), plan, network);
      rest(begun);
      begun.free();
      network.free();
    });
  }
});
