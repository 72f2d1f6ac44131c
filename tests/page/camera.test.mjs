// The live path with a fake camera: a film of an object on the board, from known poses
// (`cargo run -p vantage-lab --example fake_camera`), plays as the browser's camera.
// $VANTAGE_FILM names the film; its truth lies beside it as .json.

import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";

import { browse, DIST, idle, inspect, open, OUT, save, serve } from "./harness.mjs";
import { readZip } from "./zips.mjs";

const film = process.env.VANTAGE_FILM ?? join(OUT, "film.y4m");

/** A place counts as a stop of the film within this angle; the page's zone is 12 degrees wide. */
const NEAR_DEG = 10;
/** So often may the film come round until the shutter has fired twice; one or two do. */
const ROUNDS = 8;

describe("a capture by the board, with a film as camera", { skip: existsSync(film) ? false : `${film} is not there` }, () => {
  const truth = existsSync(film) ? JSON.parse(readFileSync(film.replace(/\.y4m$/, ".json"), "utf8")) : null;
  let server;
  let browser;
  const hints = new Set();
  const stops = truth?.frames.filter(({ kind }) => kind === "steady") ?? [];
  before(async () => {
    server = await serve({ "/": DIST });
    browser = await browse({ viewport: { width: 390, height: 844 } }, [
      "--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream", `--use-file-for-fake-video-capture=${film}`,
    ]);
    await browser.page.exposeFunction("hinted", (name) => hints.add(name));
    await browser.page.addInitScript(listen);
  });
  after(async () => {
    await browser.close();
    await server.close();
  });

  test("the shutter fires by itself; what is wrong with a frame is said", async () => {
    const { page } = browser;
    await open(page, server.url);
    await page.getByRole("button", { name: "Set up a capture" }).click();
    await page.getByLabel(/a mug/).check();
    await page.getByRole("button", { name: "Start the camera" }).click();
    await page.locator(".stagebox video").waitFor();
    await page.evaluate(() => {
      const look = () => {
        const name = document.querySelector("[data-hint]")?.getAttribute("data-hint");
        if (name) globalThis.hinted(name);
      };
      new MutationObserver(look).observe(document.body, { subtree: true, childList: true, attributes: true, attributeFilter: ["data-hint"] });
    });
    await page.locator(".tagline").first().waitFor({ state: "attached" });
    await page.screenshot({ path: join(OUT, "camera-390.png"), fullPage: true });
    const taken = () => page.locator(".strip li").count();
    // The film's camera comes to each of its stops again and again. Where it does not come, the planner
    // is told that nobody can get there. How soon it comes is the film's affair: the limit is only so
    // that a shutter that never fires ends the test.
    const due = ["fast", "dark", "lost", "bright", "blurred"];
    const isDone = async () => (await taken()) >= 2 && due.every((name) => hints.has(name));
    const roundMs = (1000 * truth.frames.length) / truth.fps;
    const end = Date.now() + ROUNDS * roundMs;
    while (Date.now() < end && !(await isDone())) {
      const view = await page.evaluate(() => globalThis.lastView);
      const block = page.getByRole("button", { name: "Can’t get there" });
      if (view.next && !stops.some((stop) => angleDeg(stop, view) < NEAR_DEG) && (await block.isEnabled())) await block.click();
      else await page.waitForTimeout(200);
    }
    assert.ok((await taken()) >= 2, `${await taken()} photos were taken by themselves`);
    for (const name of due) assert.ok(hints.has(name), `${name} is not among ${[...hints].join(", ")}`);
  });

  test("the manual shutter takes photos anywhere", async () => {
    const { page } = browser;
    await page.getByLabel("Take photos by itself").uncheck();
    for (let i = 0; i < 8; i += 1) {
      await page.getByRole("button", { name: "Take a photo now" }).click();
      await page.waitForTimeout(600);
    }
    await idle(page);
  });

  test("the screen suits eyes, ears and small phones", async () => {
    await inspect(browser.page, "camera");
  });

  test("the saved poses are those of the film's camera", async () => {
    const { page } = browser;
    await page.getByRole("button", { name: /^Review/ }).click();
    await idle(page);
    const files = readZip(await save(page, "camera.zip"));
    const record = JSON.parse(files.get("my-object/capture.json"));
    assert.ok(record.photos.length >= 6);
    const errors = [];
    for (const { file, pose, source } of record.photos) {
      assert.equal(source, "board");
      const picture = files.get(`my-object/images/${file}`).toString("base64");
      const { width, height, number } = await page.evaluate(stampOf, { picture, bits: truth.stamp?.bits ?? 10, side: truth.stamp?.px ?? 8 });
      assert.deepEqual([width, height], [640, 480]);
      const frame = truth.frames[number];
      assert.ok(frame, `frame ${number}`);
      if (frame.kind === "moving" || frame.kind === "blurred") continue;
      errors.push(difference(pose, frame.pose));
    }
    assert.ok(errors.length >= 3, `${errors.length} photos of a camera that stood still`);
    const turn = median(errors.map((error) => error.turnDeg));
    const shift = median(errors.map((error) => error.shift));
    console.log(`${errors.length} poses: median error ${turn.toFixed(2)} degrees, ${(100 * shift).toFixed(2)} % of the distance`);
    assert.ok(turn < 1 && shift < 0.02, `${turn} degrees, ${shift} of the distance`);
    assert.deepEqual(browser.problems, []);
  });
});

/** Runs in the page before its scripts: keeps what the worker said last about the capture. */
function listen() {
  globalThis.Worker = class extends Worker {
    constructor(...where) {
      super(...where);
      this.addEventListener("message", ({ data: { view } }) => {
        if (view) globalThis.lastView = { next: view.next && [...view.next.pose], centre: view.record.layout.centre };
      });
    }
  };
}

/** The angle about the object between a frame of the film and the next view. */
function angleDeg({ pose }, { next, centre }) {
  const place = (rows) => [rows[3], rows[7], rows[11]];
  const unit = (v) => v.map((value) => value / Math.hypot(...v));
  const [a, b] = [unit(place(pose).map((value, i) => value - centre[i])), unit(place(next))];
  return (2 * Math.asin(Math.min(1, Math.hypot(...a.map((value, i) => value - b[i])) / 2)) * 180) / Math.PI;
}

/** Runs in the page: the frame's number from the squares in its lower left corner. */
async function stampOf({ picture, bits, side }) {
  const bytes = Uint8Array.from(atob(picture), (sign) => sign.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/jpeg" }));
  const drawing = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  drawing.drawImage(bitmap, 0, 0);
  let number = 0;
  for (let bit = 0; bit < bits; bit += 1) {
    const [level] = drawing.getImageData(bit * side + side / 2, bitmap.height - side / 2, 1, 1).data;
    number += level > 127 ? 2 ** bit : 0;
  }
  return { width: bitmap.width, height: bitmap.height, number };
}

function difference(a, b) {
  const column = (pose, c) => [pose[c], pose[4 + c], pose[8 + c]];
  const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  const apart = (c) => column(a, c).map((value, row) => value - column(b, c)[row]);
  // |A - B| = 2 sqrt(2) sin(angle / 2), exact also for the smallest angles.
  const norm = Math.sqrt([0, 1, 2].reduce((sum, c) => sum + dot(apart(c), apart(c)), 0));
  const turnDeg = (2 * Math.asin(Math.min(1, norm / Math.sqrt(8))) * 180) / Math.PI;
  return { turnDeg, shift: Math.hypot(...apart(3)) / Math.hypot(...column(b, 3)) };
}

function median(values) {
  return [...values].sort((x, y) => x - y)[Math.floor(values.length / 2)];
}
