// The plan in the browser is that of Node, bit for bit, in both builds. That of Node is the host's:
// wasm/tests/golden.test.mjs.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";

import { browse, serve } from "./harness.mjs";
import { plan } from "./plan.js";

const HERE = dirname(fileURLToPath(import.meta.url));
const PACKAGE = join(HERE, "../../wasm/pkg");

test("a session by photos, in Chromium and in Node", async () => {
  const { load } = await import(pathToFileURL(join(PACKAGE, "node.js")));
  const due = plan(await load(), new Uint8Array(readFileSync(join(PACKAGE, "soarnet.model"))));
  assert.ok(due.length > 60, `${due.length} lines`);
  const server = await serve({ "/": HERE, "/pkg/": PACKAGE });
  const { page, close } = await browse();
  try {
    for (const build of ["simd", "scalar"]) {
      await page.goto(`${server.url}bench.html`);
      const found = await page.evaluate(async (build) => {
        const [{ load }, { plan }] = await Promise.all([import("/pkg/browser.js"), import("/plan.js")]);
        const bytes = new Uint8Array(await (await fetch("/pkg/soarnet.model")).arrayBuffer());
        return plan(await load({ build }), bytes);
      }, build);
      assert.deepEqual(found, due, build);
    }
  } finally {
    await close();
    await server.close();
  }
});
