// Browsers that lack something: the page says so, or goes another way.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { beginSimulation, browse, DIST, idle, open, save, serve, take } from "./harness.mjs";
import { readZip } from "./zips.mjs";

let server;
before(async () => { server = await serve({ "/": DIST }); });
after(() => server.close());

/** A browser whose worker begins with a script of the test's. */
async function lacking(script, options = {}, flags = []) {
  const browser = await browse({ serviceWorkers: "block", ...options }, flags);
  await browser.context.route(/worker-[^/]*\.js$/, async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, body: `${script};\n${await response.text()}` });
  });
  return browser;
}

test("without a private file system, IndexedDB keeps the photos", async () => {
  const { page, close } = await lacking("navigator.storage.getDirectory = () => Promise.reject(new Error('no'))");
  try {
    await open(page, server.url);
    await beginSimulation(page);
    await take(page, 2);
    await page.reload();
    await page.getByText("2 photos").waitFor();
    await page.getByRole("button", { name: "Go on" }).click();
    await page.getByRole("heading", { name: "Next: photo 3" }).waitFor();
    await idle(page);
    await take(page, 1);
    await page.getByRole("button", { name: "Review and save" }).click();
    const files = readZip(await save(page, "indexeddb.zip"));
    assert.equal(JSON.parse(files.get("toy-engine/transforms.json")).frames.length, 3);
  } finally {
    await close();
  }
});

test("without any storage, the page says that nothing is kept, and still saves", async () => {
  const { page, close } = await lacking("navigator.storage.getDirectory = () => Promise.reject(new Error('no')); Object.defineProperty(self, 'indexedDB', { value: undefined })");
  try {
    await open(page, server.url);
    await page.getByText("Nothing is kept").waitFor();
    await beginSimulation(page);
    await take(page, 1);
    await page.getByRole("button", { name: "Review and save" }).click();
    const files = readZip(await save(page, "memory.zip"));
    assert.equal(JSON.parse(files.get("toy-engine/transforms.json")).frames.length, 1);
  } finally {
    await close();
  }
});

test("without WebAssembly, the page says what is needed", async () => {
  const { page, close } = await lacking("Object.defineProperty(self, 'WebAssembly', { value: undefined })");
  try {
    await page.goto(server.url);
    await page.getByRole("heading", { name: "This browser cannot run the planner" }).waitFor();
    assert.match(await page.locator("main").textContent(), /WebAssembly/);
  } finally {
    await close();
  }
});

test("without vectors in WebAssembly, the other build runs", async () => {
  const { page, close } = await lacking("const validate = WebAssembly.validate; WebAssembly.validate = () => false");
  try {
    const asked = [];
    page.on("request", (request) => asked.push(request.url()));
    page.context().on("request", (request) => asked.push(request.url()));
    await open(page, server.url);
    await beginSimulation(page);
    await take(page, 1);
    assert.ok(asked.some((url) => url.includes("vantage_scalar")), "the scalar build was not asked for");
    assert.ok(!asked.some((url) => url.includes("vantage_simd")));
  } finally {
    await close();
  }
});

test("without a board, the phone's orientation guides, and the export warns of its poses", async () => {
  const flags = ["--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream"];
  const { page, context, close } = await browse({ viewport: { width: 360, height: 740 } }, flags);
  try {
    const session = await context.newCDPSession(page);
    await session.send("DeviceOrientation.setDeviceOrientationOverride", { alpha: 40, beta: 60, gamma: 0 });
    await open(page, server.url);
    await page.getByRole("button", { name: "Set up a capture" }).click();
    await page.getByText("No printer?").click();
    await page.getByRole("button", { name: "Start without a board" }).click();
    await page.locator(".stagebox video").waitFor();
    await page.locator(".say h1", { hasText: "Move" }).waitFor();
    assert.match(await page.locator("main").textContent(), /Direction only.*a guess/);
    await page.getByRole("button", { name: "Take a photo now" }).click();
    await page.locator(".strip li").first().waitFor();
    await idle(page);
    await session.send("DeviceOrientation.setDeviceOrientationOverride", { alpha: 130, beta: 70, gamma: 0 });
    await page.waitForTimeout(300);
    await page.getByRole("button", { name: "Take a photo now" }).click();
    await page.locator(".strip li").nth(1).waitFor();
    await idle(page);
    await page.getByRole("button", { name: /^Review/ }).click();
    const files = readZip(await save(page, "orientation.zip"));
    assert.match(files.get("my-object/README.md").toString(), /poses are guesses/);
    const { frames } = JSON.parse(files.get("my-object/transforms.json"));
    // 90 degrees further round, seen from above.
    const azimuth = ({ transform_matrix: m }) => Math.atan2(m[1][3], m[0][3]);
    const turn = ((azimuth(frames[1]) - azimuth(frames[0]) + 3 * Math.PI) % (2 * Math.PI)) - Math.PI;
    assert.ok(Math.abs(turn - Math.PI / 2) < 0.02, `${turn}`);
  } finally {
    await close();
  }
});
