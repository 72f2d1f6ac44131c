// The built page in a real browser: whole captures, what goes wrong, who cannot see or point.
// `node --test page.test.mjs`; the page must have been built. Zips and screenshots go to $VANTAGE_OUT.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { after, before, describe, test } from "node:test";

import { beginSimulation, browse, DIST, idle, inspect, open, OUT, save, serve, take } from "./harness.mjs";
import { pyramid } from "./models.mjs";
import { editZip, readZip, smallPng } from "./zips.mjs";

let server;
before(async () => { server = await serve({ "/": DIST }); });
after(() => server.close());

const notice = (page) => page.locator(".notice span").textContent();

describe("a simulated capture", () => {
  let browser;
  let zip;
  before(async () => { browser = await browse(); });
  after(() => browser.close());

  test("is begun, survives a reload in the middle, and is gone on with", async () => {
    const { page } = browser;
    await open(page, server.url);
    await inspect(page, "start");
    await beginSimulation(page);
    await take(page, 3);
    await page.reload();
    await page.getByText("3 photos").waitFor();
    await page.getByRole("button", { name: "Go on" }).click();
    await page.getByRole("heading", { name: "Next: photo 4" }).waitFor();
    await idle(page);
    // The curves are computed anew from the same photos.
    assert.match(await page.locator(".chart svg").first().getAttribute("aria-label"), /after 3 photos: Vantage \d/);
    await page.keyboard.press("t");
    await page.getByRole("heading", { name: "Next: photo 5" }).waitFor();
    await inspect(page, "simulate");
  });

  test("runs to its end, by the keyboard alone", async () => {
    const { page } = browser;
    await page.getByRole("button", { name: "Take all" }).focus();
    await page.keyboard.press("Enter");
    await page.getByRole("heading", { name: "Done" }).waitFor();
    await idle(page);
    const curve = await page.locator(".chart svg").first().getAttribute("aria-label");
    const [, covered] = /Vantage (\d+) %/.exec(curve) ?? [];
    assert.ok(Number(covered) > 90, curve);
    await page.screenshot({ path: join(OUT, "simulated.png"), fullPage: true });
  });

  test("is reviewed: the best found, one deleted and taken again", async () => {
    const { page } = browser;
    await page.getByRole("button", { name: "Review and save" }).click();
    const count = await page.locator(".card").count();
    await page.getByRole("button", { name: "Find the best" }).click();
    await page.locator(".rank").first().waitFor();
    assert.equal(await page.locator(".leftout").count(), Math.max(0, count - 12));
    await page.getByRole("button", { name: /^Photo 2\b/ }).click();
    await inspect(page, "review");
    await page.getByRole("button", { name: "Delete, and plan it anew" }).click();
    await page.getByRole("heading", { name: `${count - 1} photos` }).waitFor();
    await idle(page);
    await page.getByRole("button", { name: "Take more photos" }).click();
    await take(page, 1);
    await page.getByRole("button", { name: "Review and save" }).click();
    assert.equal(await page.locator(".card").count(), count);
  });

  test("leaves as a zip that holds what it says", async () => {
    const { page } = browser;
    const count = await page.locator(".card").count();
    zip = await save(page, "simulated.zip");
    const files = readZip(zip);
    // For other people's readers: `cargo xtask test page-readers`.
    for (const [path, content] of files) {
      mkdirSync(dirname(join(OUT, path)), { recursive: true });
      writeFileSync(join(OUT, path), content);
    }
    const transforms = JSON.parse(files.get("toy-engine/transforms.json"));
    assert.equal(transforms.frames.length, count);
    for (const { file_path } of transforms.frames) assert.ok(files.get(`toy-engine/${file_path}`)?.length > 1000, file_path);
    const record = JSON.parse(files.get("toy-engine/capture.json"));
    assert.deepEqual([...new Set(record.photos.map(({ source }) => source))], ["simulated"]);
    assert.ok(record.photos.every(({ reason, quality, scores }) => reason && quality && scores));
    assert.match(files.get("toy-engine/README.md").toString(), /ns-train splatfacto --data \./);
    assert.deepEqual(browser.problems, []);
  });

  test("opened again with half its photos gone, it tells which views to take", async () => {
    const { page } = browser;
    const half = join(OUT, "half.zip");
    // All photos from the side of +y are missing.
    editZip(zip, half, (files) => {
      const transforms = JSON.parse(files.get("toy-engine/transforms.json"));
      transforms.frames = transforms.frames.filter(({ transform_matrix: m }) => m[1][3] < 0);
      files.set("toy-engine/transforms.json", Buffer.from(JSON.stringify(transforms)));
      files.delete("toy-engine/capture.json");
    });
    await page.getByRole("button", { name: "Vantage, start page" }).click();
    await page.locator('input[accept=".zip"]').setInputFiles(half);
    await page.getByRole("heading", { name: "Take these next" }).waitFor();
    await inspect(page, "import");
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save the list" }).click()]);
    const { next } = JSON.parse(readFileSync(await download.path(), "utf8"));
    assert.ok(next.length >= 3);
    assert.ok(next[0].transform_matrix[1][3] > 0, "the first view to take is on the side that is missing");
  });

  test("opened again whole, it can be gone on with", async () => {
    const { page } = browser;
    await page.getByRole("button", { name: "Vantage, start page" }).click();
    await page.locator('input[accept=".zip"]').setInputFiles(zip);
    await page.getByRole("button", { name: "Go on with this capture" }).click();
    await page.getByRole("heading", { name: /Next|Done/ }).waitFor();
    await idle(page);
    assert.ok((await page.locator(".strip li").count()) > 5);
    assert.deepEqual(browser.problems, []);
  });
});

describe("what goes wrong is said, and nothing is lost", () => {
  let browser;
  before(async () => { browser = await browse(); });
  after(() => browser.close());

  test("a full storage", async () => {
    const { page, context } = browser;
    await open(page, server.url);
    await beginSimulation(page);
    await take(page, 2);
    const session = await context.newCDPSession(page);
    const { origin } = new URL(server.url);
    const used = await page.evaluate(async () => (await navigator.storage.estimate()).usage ?? 0);
    await session.send("Storage.overrideQuotaForOrigin", { origin, quotaSize: used + 100_000 });
    await page.getByRole("button", { name: "Take this photo" }).click();
    assert.match(await notice(page), /storage is full.*Nothing is lost/i);
    await session.send("Storage.overrideQuotaForOrigin", { origin });
    await page.reload();
    await page.getByText("2 photos").waitFor();
    await page.getByRole("button", { name: "Go on" }).click();
    await page.getByRole("heading", { name: "Next: photo 3" }).waitFor();
    await take(page, 1);
  });

  test("files that are no captures", async () => {
    const { page } = browser;
    await page.getByRole("button", { name: "Vantage, start page" }).click();
    const zips = page.locator('input[accept=".zip"]');
    const give = async (input, name, bytes) => {
      await idle(page);
      await input.setInputFiles({ name, mimeType: "", buffer: Buffer.from(bytes) });
      await page.locator(".notice").waitFor();
      const words = await notice(page);
      await page.getByRole("button", { name: "Close this message" }).click();
      return words;
    };
    assert.match(await give(zips, "torn.zip", "PK\x03\x04 torn"), /damaged or not a zip/);
    assert.match(await give(zips, "letter.zip", readFileSync(join(OUT, "other.zip"))), /no transforms\.json/);
    await page.getByRole("button", { name: "Vantage, start page" }).click();
    assert.match(await give(page.locator('input[accept=".glb"]'), "cube.glb", "this is no model"), /not a GLB/);
    // The capture before is still there.
    await page.getByText("3 photos").waitFor();
  });

  test("a huge picture and a broken one are left out by name", async () => {
    const { page } = browser;
    await page.locator('input[accept=".zip"]').setInputFiles(join(OUT, "huge.zip"));
    await page.getByRole("heading", { name: "Take these next" }).waitFor();
    const words = await page.locator("details").textContent();
    assert.match(words, /30000 x 30000 pixels, more than this page decodes/);
    assert.match(words, /damaged/);
  });

  before(() => {
    editZip(null, join(OUT, "other.zip"), (files) => files.set("letter.txt", Buffer.from("dear reader")));
    // Four usable photos of one small PNG, one that says it is enormous, one cut short.
    const png = smallPng();
    const huge = Buffer.from(png);
    huge.writeUInt32BE(30000, 16);
    huge.writeUInt32BE(30000, 20);
    editZip(null, join(OUT, "huge.zip"), (files) => {
      const frames = Array.from({ length: 6 }, (_, i) => {
        const [c, s] = [Math.cos(i), Math.sin(i)];
        files.set(`images/${i}.png`, i === 4 ? huge : i === 5 ? png.subarray(0, 40) : png);
        return { file_path: `images/${i}.png`, transform_matrix: [[-s, 0, c, 3 * c], [c, 0, s, 3 * s], [0, 1, 0, 0], [0, 0, 0, 1]] };
      });
      files.set("transforms.json", Buffer.from(JSON.stringify({ camera_angle_x: 0.7, frames })));
    });
  });

  test("a camera that is refused, and none at all", async () => {
    const { page, context } = browser;
    await page.getByRole("button", { name: "Vantage, start page" }).click();
    await page.getByRole("button", { name: "Set up a capture" }).click();
    await page.getByRole("button", { name: "Print, or save as PDF" }).waitFor();
    await page.evaluate(() => { globalThis.print = () => { globalThis.isPrinted = true; }; });
    await page.getByRole("button", { name: "Print, or save as PDF" }).click();
    await page.waitForFunction(() => globalThis.isPrinted);
    await idle(page);
    // One sheet, true to size: A4 held sideways, in points.
    const pdf = (await page.pdf({ preferCSSPageSize: true })).toString("latin1");
    assert.equal(pdf.match(/\/Type\s*\/Page\b/g)?.length, 1);
    const [, width, height] = /MediaBox\s*\[\s*0\s+0\s+([\d.]+)\s+([\d.]+)/.exec(pdf) ?? [];
    assert.ok(Math.abs(width - 841.9) < 1.5 && Math.abs(height - 595.3) < 1.5, `${width} x ${height}`);
    await inspect(page, "setup");
    const session = await context.newCDPSession(page);
    const start = async () => {
      await page.getByRole("button", { name: "Start the camera" }).click();
      await page.locator(".notice").waitFor();
      const words = await notice(page);
      await page.getByRole("button", { name: "Close this message" }).click();
      return words;
    };
    const { origin } = new URL(server.url);
    const permission = { name: "camera" };
    await session.send("Browser.setPermission", { origin, permission, setting: "granted" });
    assert.match(await start(), /There is no camera/);
    await session.send("Browser.setPermission", { origin, permission, setting: "denied" });
    assert.match(await start(), /refused|no camera/);
    await page.getByRole("button", { name: "Vantage, start page" }).click();
    await page.getByText("3 photos").waitFor();
  });
});

test("with the network off, the page opens, plans, and saves", async () => {
  const { page, context, problems, close } = await browse();
  try {
    const home = await serve({ "/some/folder/": DIST });
    const url = `${home.url}some/folder/`;
    await open(page, url);
    await page.evaluate(() => navigator.serviceWorker.ready);
    // Every file of the build is kept, also those that no screen has asked for.
    await home.close();
    await context.setOffline(true);
    await page.goto(url);
    await page.locator("button.main:not([disabled])").first().waitFor();
    await page.getByText("Offline ·").waitFor();
    await beginSimulation(page);
    await take(page, 2);
    await page.getByRole("button", { name: "Review and save" }).click();
    const files = readZip(await save(page, "offline.zip"));
    assert.equal(JSON.parse(files.get("toy-engine/transforms.json")).frames.length, 2);
    assert.deepEqual(problems.filter((text) => !text.includes("ERR_INTERNET_DISCONNECTED")), []);
  } finally {
    await close();
  }
});

test("a GLB of one's own is photographed, and is there again after a reload", async () => {
  const { page, problems, close } = await browse();
  try {
    await open(page, server.url);
    await page.locator('input[accept=".glb"]').setInputFiles({ name: "pyramid.glb", mimeType: "model/gltf-binary", buffer: pyramid() });
    await page.getByRole("heading", { name: "Next: photo 1" }).waitFor();
    await take(page, 1);
    await page.reload();
    await page.getByRole("button", { name: "Go on" }).click();
    await page.getByRole("heading", { name: "Next: photo 2" }).waitFor();
    await idle(page);
    await take(page, 1);
    // Seen from two sides; of a pyramid three faces at least, of the four that can be seen.
    assert.match(await page.locator(".chart svg").first().getAttribute("aria-label"), /after 2 photos: Vantage (7[5-9]|100) %/);
    await page.getByRole("button", { name: "Review and save" }).click();
    const files = readZip(await save(page, "pyramid.zip"));
    // The texture is grey: had it not loaded, the photo would be white or black.
    const shade = await page.evaluate(shadeOf, files.get("pyramid/images/frame_00001.png").toString("base64"));
    assert.ok(shade > 40 && shade < 140, `${shade}`);
    assert.deepEqual(problems, []);
  } finally {
    await close();
  }
});

/** Runs in the page: the mean brightness of the opaque pixels of a PNG. */
async function shadeOf(png) {
  const bytes = Uint8Array.from(atob(png), (sign) => sign.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
  const drawing = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  drawing.drawImage(bitmap, 0, 0);
  const { data } = drawing.getImageData(0, 0, bitmap.width, bitmap.height);
  let [sum, count] = [0, 0];
  for (let i = 0; i < data.length; i += 4) {
    if (data[i + 3] < 255) continue;
    sum += data[i];
    count += 1;
  }
  return sum / count;
}

test("nothing is asked of any other host, and the policy forbids it", async () => {
  const { page, close } = await browse();
  try {
    const asked = [];
    page.on("request", (request) => asked.push(new URL(request.url())));
    await open(page, server.url);
    await beginSimulation(page);
    await take(page, 1);
    const hosts = new Set(asked.filter(({ protocol }) => protocol.startsWith("http")).map(({ host }) => host));
    assert.deepEqual([...hosts], [new URL(server.url).host]);
    const refused = await page.evaluate(() => fetch("https://example.org/").then(() => "answered", (error) => error.message));
    assert.notEqual(refused, "answered");
  } finally {
    await close();
  }
});
