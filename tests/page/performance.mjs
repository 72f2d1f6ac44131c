// What the page costs: bytes over the wire, time until it is ready, one step of the planner beside
// onnxruntime-web on the same network, memory. `node performance.mjs`; prints a table and, with
// VANTAGE_CHECK=1, fails where a limit is passed.

import { readFileSync, readdirSync, statSync } from "node:fs";
import { cpus } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

import { beginSimulation, browse, DIST, idle, serve, take } from "./harness.mjs";

const HERE = dirname(fileURLToPath(import.meta.url));
const ROOT = join(HERE, "../..");
const LIMITS = { bytes: 700_000, readyMs: 1500, stepMs: 10 };

const kB = (bytes) => `${(bytes / 1000).toFixed(0)} kB`;
const ms = (time) => `${time.toFixed(time < 10 ? 2 : 0)} ms`;

/** Bytes of every file of the build, gzipped; a browser needs one of the planner's two builds. */
function allBytes(folder) {
  return readdirSync(folder).reduce((sum, name) => {
    const path = join(folder, name);
    if (statSync(path).isDirectory()) return sum + allBytes(path);
    return name.startsWith("vantage_scalar") ? sum : sum + gzipSync(readFileSync(path), { level: 9 }).length;
  }, 0);
}

/** Loads the page in a fresh browser: when it is ready, and what came over the wire until then. */
async function load(server) {
  // The service worker fetches the rest beside it: it is left out here.
  const { page, close } = await browse({ serviceWorkers: "block" });
  try {
    const before = server.sent();
    await page.goto(server.url);
    await page.locator("button.main:not([disabled])").first().waitFor();
    return { readyMs: await page.evaluate(() => performance.now()), bytes: server.sent() - before };
  } finally {
    await close();
  }
}

/** Memory of the page and its worker after some photos. */
async function memory(server) {
  const { page, close } = await browse();
  try {
    await page.goto(server.url);
    await beginSimulation(page);
    await take(page, 5);
    await idle(page);
    const heap = await page.evaluate(() => performance.memory?.usedJSHeapSize ?? 0);
    return heap;
  } finally {
    await close();
  }
}

async function steps() {
  const server = await serve({ "/": HERE, "/pkg/": join(ROOT, "wasm/pkg"), "/ort/": join(HERE, "node_modules/onnxruntime-web/dist"), "/models/": join(ROOT, "lab/models") });
  try {
    const results = {};
    for (const [name, call] of [["simd", "ours('simd')"], ["scalar", "ours('scalar')"], ["onnx", "onnx()"], ["simd again", "ours('simd')"]]) {
      const { page, close } = await browse();
      try {
        await page.goto(`${server.url}bench.html`);
        await page.waitForFunction(() => globalThis.bench !== undefined);
        results[name] = await page.evaluate(`bench.${call}`);
      } finally {
        await close();
      }
    }
    return results;
  } finally {
    await server.close();
  }
}

const server = await serve({ "/": DIST });
const total = allBytes(DIST);
const loads = [];
for (let i = 0; i < 5; i += 1) loads.push(await load(server));
const ready = loads.map(({ readyMs }) => readyMs).sort((a, b) => a - b)[2];
const heap = await memory(server);
await server.close();
const step = await steps();
const times = ({ median, p95, fastest }) => `${ms(median)} / ${ms(p95)} (${ms(fastest)})`;
if (step.simd.views.join() !== step.scalar.views.join()) throw new Error("the builds with and without vectors plan differently");

const row = (name, value, limit) => console.log(`| ${name} | ${value} | ${limit} |`);
console.log(`${cpus()[0]?.model ?? "?"}, ${cpus().length} cores; headless Chromium; loads: middle of 5; steps: ${step.simd.count}\n`);
console.log("| | measured | must |\n|---|---|---|");
row("all files of the page, gzip (one of the two builds)", kB(total), kB(LIMITS.bytes));
row("of these until the page is ready", kB(loads[0].bytes), "");
row("navigation to ready, from localhost", ms(ready), ms(LIMITS.readyMs));
row("encode a photo + score 100 candidates, WebAssembly with SIMD: median / p95 (fastest)", times(step.simd), ms(LIMITS.stepMs));
row("the same without SIMD", times(step.scalar), "");
row("the network in onnxruntime-web (wasm, 1 thread), float32, outlooks given", times(step.onnx), "");
row("with SIMD again, after the others", times(step["simd again"]), "");
row("JavaScript heap of the page after 5 photos", `${(heap / 1e6).toFixed(1)} MB`, "");

const over = [
  total > LIMITS.bytes && "the bytes", ready > LIMITS.readyMs && "the time to ready", step.simd.median > LIMITS.stepMs && "the step",
].filter(Boolean);
if (over.length > 0 && process.env.VANTAGE_CHECK) {
  console.error(`over the limit: ${over.join(", ")}`);
  process.exit(1);
}
