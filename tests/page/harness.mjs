// A browser with the built page in it: a file server, Chromium, and what tests ask of both.

import assert from "node:assert/strict";
import { createReadStream, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { createGzip } from "node:zlib";

import { chromium } from "playwright-core";

const HERE = dirname(fileURLToPath(import.meta.url));
export const DIST = process.env.VANTAGE_DIST ?? join(HERE, "../../web/dist");
export const OUT = process.env.VANTAGE_OUT ?? join(HERE, "out");
mkdirSync(OUT, { recursive: true });
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const TYPES = {
  ".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8", ".mjs": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8", ".wasm": "application/wasm", ".svg": "image/svg+xml", ".json": "application/json",
  ".webmanifest": "application/manifest+json",
};

/** Serves folders by their prefix, gzipped as a host would; `sent` counts the bytes of the answers. */
export async function serve(folders) {
  let sent = 0;
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    const prefix = Object.keys(folders).filter((name) => path.startsWith(name)).sort((a, b) => b.length - a.length)[0];
    const below = path.slice(prefix.length) || "index.html";
    const file = join(folders[prefix], below);
    if (!existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404, { "Content-Type": "text/plain" }).end("no such file");
      return;
    }
    response.writeHead(200, { "Content-Type": TYPES[extname(file)] ?? "application/octet-stream", "Content-Encoding": "gzip" });
    const zipped = createReadStream(file).pipe(createGzip({ level: 9 }));
    zipped.on("data", (part) => { sent += part.length; });
    zipped.pipe(response);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address();
  return { url: `http://localhost:${port}/`, sent: () => sent, close: () => new Promise((resolve) => { server.closeAllConnections(); server.close(resolve); }) };
}

const FLAGS = [
  "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync", "--enable-unsafe-swiftshader",
];

/** A browser of its own profile, so that storage and service workers are real; `options` as Playwright's. */
export async function browse(options = {}, flags = []) {
  const profile = mkdtempSync(join(tmpdir(), "vantage-page-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.VANTAGE_CHROMIUM ?? "/usr/bin/chromium",
    args: [...FLAGS, ...flags],
    viewport: { width: 1280, height: 860 },
    reducedMotion: "reduce",
    acceptDownloads: true,
    ...options,
  });
  context.setDefaultTimeout(300_000); // WebGL without a GPU takes minutes for a capture on a machine under load
  const problems = [];
  context.on("console", (message) => {
    // Chromium counts its own software renderer's stalls as warnings; only errors are ours.
    if (message.type() === "error") problems.push(`console: ${message.text()}`);
  });
  context.on("weberror", (error) => problems.push(`error: ${error.error().message}`));
  context.on("dialog", (dialog) => dialog.accept());
  const close = async () => {
    await context.close();
    rmSync(profile, { recursive: true, force: true, maxRetries: 3 });
  };
  return { context, page: context.pages()[0] ?? (await context.newPage()), problems, close };
}

/** Opens the page and waits until the planner is there. */
export async function open(page, url) {
  await page.goto(url);
  await page.locator("button.main:not([disabled])").first().waitFor();
}

/** Begins the simulated capture. */
export async function beginSimulation(page) {
  await page.getByRole("button", { name: "Start with the toy engine" }).click();
  await page.getByRole("heading", { name: "Next: photo 1" }).waitFor();
}

/** Takes the next `count` photos one by one. */
export async function take(page, count) {
  for (let i = 0; i < count; i += 1) {
    const before = await page.locator(".strip li").count();
    await page.getByRole("button", { name: "Take this photo" }).click();
    await page.locator(".strip li").nth(before).waitFor();
    await idle(page);
  }
}

/** Waits until the page does nothing. */
export async function idle(page) {
  await page.locator(".busy:empty").waitFor({ state: "attached" });
}

/** Packs the capture and saves the zip; returns its path. */
export async function save(page, name) {
  await page.getByRole("button", { name: "Pack the zip" }).click();
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#download").click()]);
  const path = join(OUT, name);
  await download.saveAs(path);
  return path;
}

/** Whatever a screen reader or a keyboard would stumble over. */
async function checkAxe(page, screen) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  const words = violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(" | ")}`);
  assert.deepEqual(words, [], `${screen}: axe`);
}

/** The screen at the width of a small phone and of a laptop, in light and dark; checked and drawn. */
export async function inspect(page, screen, viewport = { width: 1280, height: 860 }) {
  for (const [width, height] of [[360, 740], [1280, 860]]) {
    await page.setViewportSize({ width, height });
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
      if (width === 360 || colorScheme === "dark") await checkAxe(page, `${screen}, ${width} px, ${colorScheme}`);
      const overhang = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(overhang <= 0, `${screen} is ${overhang} px too wide at ${width} px`);
      await page.screenshot({ path: join(OUT, `${screen}-${width}-${colorScheme}.png`), fullPage: true });
    }
  }
  await page.emulateMedia({ colorScheme: "light", reducedMotion: "reduce" });
  await page.setViewportSize(viewport);
}
