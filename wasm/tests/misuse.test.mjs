// Whatever is passed, the module neither traps nor stays out of order, and memory is given back.

import { deepEqual, equal, ok } from "node:assert/strict";
import { test } from "node:test";
import { Worker } from "node:worker_threads";

import init from "../pkg/vantage_wasm.js";
import { pool, poseNetwork, rest, seeing, session, thrown, vantage } from "./package.mjs";

const { BoardTracker, MeshLedger, Model, Pool, Session, frameQuality } = vantage;

const photo = () => ({ pixels: new Uint8Array(3 * 64 * 64), width: 64, height: 64, format: "rgb" });
const expected = rest(session());

/** What no caller should pass. */
function oddities() {
  const detached = new Uint8Array(16);
  structuredClone(detached, { transfer: [detached.buffer] });
  const throwing = new Proxy({}, { get: () => { throw new Error("no"); } });
  return [
    undefined, null, true, "", "coverage", "7", -1, 0.5, NaN, Infinity, 2 ** 53, 1e300, 5n,
    Symbol("odd"), () => 1, {}, [], [[]], [NaN, 1, 2], new Date(NaN), throwing, detached,
    { length: 2 ** 40 }, { share: () => ({}) }, { share: () => { throw new Error("no"); } },
    { kind: throwing }, { scheme: {}, budget: {} }, { pixels: detached, width: 1, height: 1, format: "rgb" },
    { pixels: new Uint8Array(4), width: 4294967295, height: 4294967295, format: "rgba" },
    { scheme: "ensemble", budget: 5, stop: throwing }, { left: 1, top: 1, side: 1 },
    new Uint8Array(12), new Uint8ClampedArray(3), new Uint32Array(3), new Uint32Array([4294967295]),
    new Float32Array(12), new Float32Array(9).fill(1e38), new Float32Array([NaN]), new Float64Array(12),
    new ArrayBuffer(8), new DataView(new ArrayBuffer(8)), pool(3), seeing, session(),
  ];
}

/** Every way in, with places for oddities. */
const calls = [
  (a, b) => new Pool(a, 9, 1, b),
  (a, b) => new Pool({ kind: "fibonacci-sphere" }, a, b),
  (a, b) => new Pool({ kind: "spiral", turns: a, minElevationRad: b, maxElevationRad: 1 }, 9, 1),
  (a, b) => new Pool({ kind: "rings", rings: a, minElevationRad: 0, maxElevationRad: b }, 9, 1),
  (a, b) => new Pool({ kind: "random-sphere", seed: a }, 9, 1, [b, 0, 0]),
  (a, b) => Pool.fromPoses(a, b),
  (a) => new Model(a),
  (a, b) => new Session(pool(9), a, b),
  (a, b) => new Session(a, { scheme: "random", budget: 3 }, b),
  (a, b) => session({ scheme: a, budget: b }),
  (a, b) => session({ seed: a, movementCost: b }),
  (a, b) => session({ stop: { gain: a, patience: b } }),
  (a, b) => session({ start: a, startViews: b }),
  (a, b) => session({ centre: [a, b, 0] }),
  (a, b) => Session.restore(a, b),
  (a, b) => session().observe(a, b),
  (a, b) => session().observe(0, a, b),
  (a, b) => session().observe(0, { ...photo(), pixels: a, format: b }),
  (a, b) => session().observe(0, { ...photo(), width: a, height: b }),
  (a, b) => session().observe(0, { ...photo(), window: { left: a, top: b, side: 9 } }),
  (a, b) => session().observe(0, { ...photo(), window: { left: 1, top: a, side: b } }),
  (a, b) => new Session(pool(9), { scheme: "sum", budget: 3 }, seeing).observe(0, a, b),
  (a, b) => session().observeElsewhere(a, b),
  (a) => session().block(a),
  (a) => session().skip(a),
  (a) => session().unblock(a),
  (a) => session().gains(a),
  (a) => session().tour(a),
  (a) => session().replan(a),
  (a, b) => new BoardTracker({ columns: a, rows: b }),
  (a, b) => new BoardTracker({ tagSizeM: a, gapM: b, firstId: a }),
  (a) => new BoardTracker(a),
  (a, b) => new BoardTracker().track(a, b, 3),
  (a, b) => new BoardTracker().track(new Uint8Array(12), a, b),
  (a, b) => new BoardTracker().setIntrinsics(a, b, b),
  (a) => new BoardTracker().svg(a),
  (a, b) => frameQuality(a, b, 3),
  (a, b) => new MeshLedger(a, b),
  (a, b) =>
    new MeshLedger(Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), Uint32Array.of(0, 1, 2)).observe(a, b),
];

test("nothing that is passed traps, and everything works afterwards", () => {
  const odd = oddities();
  for (const call of calls) {
    for (const [place, first] of odd.entries()) {
      for (const second of call.length > 1 ? [undefined, odd[(7 * place + 3) % odd.length], first] : [undefined]) {
        const error = thrown(() => call(first, second));
        ok(error === undefined || error instanceof Error, `${call}`);
        ok(!(error instanceof WebAssembly.RuntimeError), `${call} traps: ${error?.stack}`);
      }
    }
  }
  deepEqual(rest(session()), expected);
});

test("a photo whose fields come from elsewhere is read once and may call back", () => {
  const outer = session();
  const inner = session();
  const sly = { ...photo(), get width() { inner.observe(0); return 64; } };
  outer.observe(0, sly);
  equal(inner.progress().views, 1);
  // Into the same session it is refused, and both go on.
  const loop = { ...photo(), get width() { outer.observe(1); return 64; } };
  ok(!(thrown(() => outer.observe(1, loop)) instanceof WebAssembly.RuntimeError));
  deepEqual(rest(session()), expected);
});

test("what is freed can be freed by `using`, and not be used", () => {
  const freed = session();
  freed[Symbol.dispose]();
  ok(thrown(() => freed.nextView()) instanceof Error);
  const model = poseNetwork.share();
  const begun = new Session(pool(), { scheme: "ensemble", budget: 12 }, model);
  model.free();
  equal(thrown(() => new Session(pool(), { scheme: "sum", budget: 3 }, model)).code, "bad-argument");
  deepEqual(rest(begun), expected);
});

test("memory is given back", async () => {
  const { memory } = await init();
  const use = () => {
    const candidates = pool(100);
    const begun = new Session(candidates, { scheme: "ensemble", budget: 3 }, seeing);
    begun.observe(0, photo());
    begun.progress();
    Session.restore(begun.snapshot(), seeing).free();
    thrown(() => begun.observe(0, { ...photo(), width: 63 }));
    begun.free();
    candidates.free();
    const ledger = new MeshLedger(Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), Uint32Array.of(0, 1, 2));
    ledger.free();
  };
  for (let turn = 0; turn < 20; turn++) use();
  const before = memory.buffer.byteLength;
  for (let turn = 0; turn < 60; turn++) use();
  equal(memory.buffer.byteLength, before);
});

test("a worker loads its own", async () => {
  const source = `
    import { parentPort } from "node:worker_threads";
    import { load, loadedBuild } from ${JSON.stringify(new URL("../pkg/node.js", import.meta.url))};
    const { Pool } = await load();
    parentPort.postMessage([new Pool({ kind: "fibonacci-sphere" }, 5, 1).length, loadedBuild()]);
  `;
  const worker = new Worker(new URL(`data:text/javascript,${encodeURIComponent(source)}`));
  const message = await new Promise((resolve, reject) => worker.on("message", resolve).on("error", reject));
  deepEqual(message, [5, "simd"]);
});
