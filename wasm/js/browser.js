// The package in pages and workers: the wasm file is fetched from beside this one.

import { loader } from "./load.js";

export { hasSimd, loadedBuild } from "./load.js";
export * from "./vantage_wasm.js";

// Written out, so that bundlers find the files.
export const load = loader((build) =>
  build === "simd"
    ? new URL("./vantage_simd.wasm", import.meta.url)
    : new URL("./vantage_scalar.wasm", import.meta.url),
);
