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
  test: { include: ["tests/**/*.test.ts"], environment: "node" },
});
