import { createHash } from "node:crypto";
import { readFileSync, readdirSync } from "node:fs";
import { fileURLToPath } from "node:url";

import type { Plugin } from "vite";
import { defineConfig } from "vitest/config";

export default defineConfig({
  // Relative, so that the built page works from any folder of a server.
  base: "./",
  build: {
    target: "es2022",
    // The wasm file stays a file: streamed, cached, and allowed by the page's content policy.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
  },
  worker: { format: "es" },
  // The planner's package lies beside this folder.
  server: { fs: { allow: [".."] } },
  plugins: [serviceWorker()],
  test: { include: ["tests/**/*.test.ts"], environment: "node" },
});

/** Writes `sw.js`: src/offline/sw.js with the list of all built files and a name for this build. */
function serviceWorker(): Plugin {
  return {
    name: "service-worker",
    apply: "build",
    generateBundle(_, bundle) {
      const here = fileURLToPath(new URL(".", import.meta.url));
      const copied = readdirSync(`${here}public`);
      const files = ["./", ...Object.keys(bundle), ...copied].filter((name) => name !== "index.html").sort();
      const hash = createHash("sha256");
      for (const [name, file] of Object.entries(bundle).sort(([a], [b]) => (a < b ? -1 : 1))) {
        hash.update(name).update(file.type === "chunk" ? file.code : file.source);
      }
      for (const name of copied) hash.update(readFileSync(`${here}public/${name}`));
      const source = readFileSync(`${here}src/offline/sw.js`, "utf8")
        .replace('"FILES"', JSON.stringify(files))
        .replace('"BUILD"', JSON.stringify(hash.digest("hex").slice(0, 12)));
      this.emitFile({ type: "asset", fileName: "sw.js", source });
    },
  };
}
