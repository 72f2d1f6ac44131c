// Which of the two builds runs here, and the way to it.

import init, * as vantage from "./vantage_wasm.js";

// The smallest module with vectors: one function, () -> v128, of i32.const 0, i8x16.splat and
// i8x16.popcnt. An engine that knows no vectors finds it invalid.
const VECTORS = new Uint8Array([
  0x00, 0x61, 0x73, 0x6d, 0x01, 0x00, 0x00, 0x00, // magic, version 1
  0x01, 0x05, 0x01, 0x60, 0x00, 0x01, 0x7b, // types: () -> v128
  0x03, 0x02, 0x01, 0x00, // functions: one of type 0
  0x0a, 0x0a, 0x01, 0x08, 0x00, 0x41, 0x00, 0xfd, 0x0f, 0xfd, 0x62, 0x0b, // code
]);

/** Whether this engine has WebAssembly's vectors of 128 bits. */
export function hasSimd() {
  return typeof WebAssembly === "object" && WebAssembly.validate(VECTORS);
}

let loading;
let loaded;

/** Which build has been loaded; undefined before. */
export function loadedBuild() {
  return loaded;
}

/** A `load` function that finds its wasm file by `find`. */
export function loader(find) {
  return function load(options = {}) {
    // A failed attempt, such as one without a network, may be made again.
    loading ??= attempt(find, options.build ?? (hasSimd() ? "simd" : "scalar")).catch((error) => {
      loading = undefined;
      throw error;
    });
    return loading;
  };
}

async function attempt(find, build) {
  if (typeof WebAssembly !== "object") {
    throw refusal("no-webassembly", "this browser has no WebAssembly: update it");
  }
  if (build !== "simd" && build !== "scalar") {
    throw refusal("bad-argument", `there is no build \`${build}\`; there are simd and scalar`);
  }
  try {
    await init({ module_or_path: await find(build) });
  } catch (cause) {
    const message = `the planner (${build}) could not be loaded: ${cause?.message ?? cause}`;
    throw refusal("not-loaded", message, cause);
  }
  loaded = build;
  return vantage;
}

function refusal(code, message, cause) {
  return Object.assign(new Error(message, { cause }), { code });
}
