// The README's example runs as it stands, up to the photographer.

import { deepEqual, equal } from "node:assert/strict";
import { test } from "node:test";

import { file, vantage } from "./package.mjs";

test("the README's example plans to an end", async () => {
  const [, code] = /```js\nimport [^\n]*\n([^]*?)```/.exec(file("wasm/README.md").toString());
  const lines = [];
  const blocked = [];
  const data = new Uint8ClampedArray(4 * 64 * 64).map((_, at) => (at * at) % 251);
  const names = {
    load: async () => vantage,
    fetch: async (name) => new Response(file(`wasm/pkg/${name}`)),
    console: { log: (...words) => lines.push(words) },
    // The second view cannot be reached.
    photographFrom: async (pose) =>
      lines.length === 2 && blocked.push(pose) ? undefined : { imageData: { data, width: 64, height: 64 }, pose },
  };
  const AsyncFunction = (async () => {}).constructor;
  await new AsyncFunction(...Object.keys(names), code)(...Object.values(names));
  equal(blocked.length, 1);
  const [finish, scores] = lines.at(-1);
  equal(["good-enough", "budget-spent"].includes(finish), true);
  deepEqual(Object.keys(scores), ["coverage", "geometry", "diversity", "texture"]);
});
