// The package in Node, whose fetch reads no files.

import { readFile } from "node:fs/promises";

import { loader } from "./load.js";

export { hasSimd, loadedBuild } from "./load.js";
export * from "./vantage_wasm.js";

export const load = loader((build) =>
  readFile(new URL(`./vantage_${build}.wasm`, import.meta.url)),
);
