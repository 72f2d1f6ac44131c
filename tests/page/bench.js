// In the page: encode one photo and score 100 candidates, by the planner and by onnxruntime-web.
// `globalThis.bench` answers to performance.mjs.

const CANDIDATES = 100;
const STEPS = 200;
const SIDE = 64;

/** A photo of chance with some shape in it: a disc on grey. */
function photo(seed) {
  let state = seed * 2654435761 + 1;
  const chance = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
  const pixels = new Uint8Array(SIDE * SIDE * 3);
  const [x0, y0, r] = [24 + 16 * chance(), 24 + 16 * chance(), 14 + 8 * chance()];
  for (let i = 0; i < SIDE * SIDE; i += 1) {
    const isIn = Math.hypot((i % SIDE) - x0, Math.floor(i / SIDE) - y0) < r;
    for (let c = 0; c < 3; c += 1) pixels[3 * i + c] = isIn ? 256 * chance() : 128;
  }
  return pixels;
}

const photos = Array.from({ length: 20 }, (_, seed) => photo(seed));

function summary(times) {
  const sorted = [...times].sort((a, b) => a - b);
  const at = (share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
  return { fastest: sorted[0], median: at(0.5), p95: at(0.95), count: sorted.length };
}

/** Sessions of 20 views: each step takes a photo in and asks for the next view and all gains. */
async function ours(build) {
  const { load } = await import("/pkg/browser.js");
  const vantage = await load({ build });
  const model = new vantage.Model(new Uint8Array(await (await fetch("/pkg/soarnet.model")).arrayBuffer()));
  const space = { kind: "hemisphere", minElevationRad: 0.1, maxElevationRad: 1.3 };
  const times = [];
  const views = [];
  for (let round = 0; times.length < STEPS + 20; round += 1) {
    const pool = new vantage.Pool(space, CANDIDATES, 3);
    const session = new vantage.Session(pool, { scheme: "ensemble", budget: 21, seed: round }, model);
    for (const pixels of photos) {
      const next = session.nextView();
      const start = performance.now();
      session.observe(next.index, { pixels, width: SIDE, height: SIDE, format: "rgb" });
      session.nextView();
      session.gains("coverage");
      times.push(performance.now() - start);
      views.push(next.index);
    }
    session.free();
    pool.free();
  }
  // The first session warms the engine's compilers up.
  return { ...summary(times.slice(20, 20 + STEPS)), first: summary(times.slice(0, 1)).median, views: views.slice(0, 20) };
}

/** The same network as it was exported, float32, asked for one photo and 100 candidates: its least
 *  work. It has no outlooks to compute: they are given. */
async function onnx() {
  const ort = await import("/ort/ort.wasm.bundle.min.mjs");
  ort.env.wasm.numThreads = 1;
  ort.env.wasm.wasmPaths = "/ort/";
  const session = await ort.InferenceSession.create("/models/soarnet.onnx", { executionProviders: ["wasm"] });
  const filled = (...shape) => {
    const count = shape.reduce((a, b) => a * b, 1);
    return new ort.Tensor("float32", Float32Array.from({ length: count }, (_, i) => Math.sin(i * 1.7)), shape);
  };
  const inputs = {
    views: filled(1, 16), relations: filled(1, CANDIDATES, 16), candidates: filled(CANDIDATES, 16), count: filled(1, 4),
    outlooks: filled(CANDIDATES, 8),
  };
  const times = [];
  for (let step = 0; step < STEPS + 20; step += 1) {
    const pixels = photos[step % photos.length];
    const planes = new Float32Array(3 * SIDE * SIDE);
    const start = performance.now();
    for (let i = 0; i < SIDE * SIDE; i += 1) for (let c = 0; c < 3; c += 1) planes[c * SIDE * SIDE + i] = (pixels[3 * i + c] - 128) / 128;
    const { ranks } = await session.run({ ...inputs, photos: new ort.Tensor("float32", planes, [1, 3, SIDE, SIDE]) });
    times.push(performance.now() - start);
    if (ranks.dims.join() !== `${CANDIDATES},4` || !ranks.data.every(Number.isFinite)) throw new Error("onnxruntime-web gave no ranks");
  }
  return { ...summary(times.slice(20)), first: times[0] };
}

globalThis.bench = { ours, onnx };
