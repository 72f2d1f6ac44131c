import type * as vantage from "./vantage_wasm.js";

export * from "./vantage_wasm.js";

/** Compiled with and without WebAssembly's vectors of 128 bits; both give the same bits. */
export type Build = "simd" | "scalar";

/** The `code` of an `Error` from `load`. */
export type LoadCode = "no-webassembly" | "not-loaded" | "bad-argument";

/**
 * Loads the build that this engine runs best, or the one asked for. Nothing else of the package may be
 * called before. Later calls give what the first one loaded; a failed one may be repeated.
 */
export function load(options?: { build?: Build }): Promise<typeof vantage>;

/** Which build has been loaded; undefined before. */
export function loadedBuild(): Build | undefined;

/** Whether this engine has WebAssembly's vectors of 128 bits. */
export function hasSimd(): boolean;
