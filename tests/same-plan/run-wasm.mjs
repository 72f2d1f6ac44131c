// Runs the same-plan WebAssembly module and writes its text to standard output.
// Usage: node run-wasm.mjs <module.wasm>
import { readFileSync, writeSync } from "node:fs";

const path = process.argv[2];
if (path === undefined) {
  console.error("usage: node run-wasm.mjs <module.wasm>");
  process.exit(2);
}
const { instance } = await WebAssembly.instantiate(readFileSync(path), {});
const { memory, same_plan_run, same_plan_text } = instance.exports;
const length = same_plan_run();
// Read the memory only now: writing the text may have grown it, which detaches older views.
let rest = new Uint8Array(memory.buffer, same_plan_text(), length);
while (rest.length > 0) rest = rest.subarray(writeSync(1, rest));
