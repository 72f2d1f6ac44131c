// Runs the kernels' suite in Node: `node run-wasm.mjs MODULE`. With `--time` it encodes photos instead
// and writes JSON: milliseconds per photo, fastest of the rounds, and the digest of the result.
import { readFileSync } from "node:fs";

const [path, option] = process.argv.slice(2);
const { instance } = await WebAssembly.instantiate(readFileSync(path));
const { kernels_run, kernels_text, kernels_encode, memory } = instance.exports;

if (option === "--time") {
  const photos = 50;
  const digest = (kernels_encode(photos) >>> 0).toString(16).padStart(8, "0");
  let fastest = Infinity;
  for (let round = 0; round < 20; round++) {
    const begin = performance.now();
    kernels_encode(photos);
    fastest = Math.min(fastest, (performance.now() - begin) / photos);
  }
  console.log(JSON.stringify({ milliseconds: fastest, digest }));
} else {
  const length = kernels_run();
  const text = new TextDecoder().decode(new Uint8Array(memory.buffer, kernels_text(), length));
  console.log(text);
  if (!text.includes("cases agree")) process.exit(1);
}
