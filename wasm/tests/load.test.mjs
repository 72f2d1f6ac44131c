// Loading: which build, again, and what is said when it fails.

import { deepEqual, equal, ok, rejects } from "node:assert/strict";
import { test } from "node:test";

import { load } from "../pkg/node.js";
import * as browser from "../pkg/browser.js";
import { loadedBuild, hasSimd, loader } from "../pkg/load.js";

test("a load that failed says so and can be repeated", async () => {
  const broken = loader(async () => new Uint8Array([0, 97, 115, 109]));
  await rejects(broken(), { code: "not-loaded" });
  await rejects(loader(async () => { throw new Error("offline"); })(), { code: "not-loaded", message: /offline/ });
  await rejects(load({ build: "fast" }), { code: "bad-argument" });
  equal(loadedBuild(), undefined);

  const { WebAssembly } = globalThis;
  delete globalThis.WebAssembly;
  try {
    equal(hasSimd(), false);
    await rejects(load(), { code: "no-webassembly" });
  } finally {
    globalThis.WebAssembly = WebAssembly;
  }
});

test("without a wish the build with vectors is loaded, once", async () => {
  equal(hasSimd(), true);
  const vantage = await load();
  equal(loadedBuild(), "simd");
  equal(await load({ build: "scalar" }), vantage);
  equal(loadedBuild(), "simd");
  ok(new vantage.Pool({ kind: "fibonacci-sphere" }, 5, 1).length === 5);
});

test("where there are no vectors the other build is chosen", async () => {
  const { validate } = WebAssembly;
  WebAssembly.validate = () => false;
  try {
    const asked = [];
    // Loaded already: only the choice is looked at.
    const { loader } = await import("../pkg/load.js?again");
    await loader((build) => (asked.push(build), new Uint8Array()))().catch(() => {});
    deepEqual(asked, ["scalar"]);
  } finally {
    WebAssembly.validate = validate;
  }
});

test("browsers get the same surface", async () => {
  const node = await import("../pkg/node.js");
  deepEqual(Object.keys(browser).sort(), Object.keys(node).sort());
});
