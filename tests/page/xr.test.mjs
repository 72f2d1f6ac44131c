// A capture by the phone's own tracking (WebXR), with an emulated phone: no headset or phone was here.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";

import { browse, DIST, idle, inspect, open, save, serve } from "./harness.mjs";
import { emulate, FOV_Y_RAD, move } from "./xr-emulator.mjs";
import { readZip } from "./zips.mjs";

const SCREEN = { width: 360, height: 740 };
/** The object's middle in the emulated room (+Y up), metres; and how large the page is told that it is. */
const MIDDLE = [0.3, 0.9, -0.6];
const OBJECT_M = 0.1;

let server;
before(async () => { server = await serve({ "/": DIST }); });
after(() => server.close());

async function setUp(page) {
  await open(page, server.url);
  await page.getByRole("button", { name: "Set up a capture" }).click();
}
const begin = (page) => page.getByRole("button", { name: "Start in AR" }).click();
const aim = (page) => page.getByRole("button", { name: "The cross is on it" }).click();
const notice = (page) => page.locator(".notice span");
const shots = (page) => page.locator(".strip li").count();

/** The optical axis is in the screen's middle: the mark is there, and nothing lies over it; both buttons can be pressed. */
async function isClearInTheMiddle(page, mark) {
  const { left, top, over } = await page.evaluate((mark) => {
    const box = document.querySelector(mark).getBoundingClientRect();
    const at = (y) => document.elementFromPoint(innerWidth / 2, y);
    return { left: box.x + box.width / 2, top: box.y + box.height / 2, over: [-60, 0, 60].map((y) => at(innerHeight / 2 + y).className) };
  }, mark);
  assert.ok(Math.abs(left - SCREEN.width / 2) < 1 && Math.abs(top - SCREEN.height / 2) < 1, `${mark} at ${left}, ${top}`);
  assert.ok(over.every((name) => name.startsWith("stagebox")), `over the middle: ${over}`);
  for (const button of await page.locator(".live .shutterrow button, .live .actions button").all()) {
    const { y, height } = await button.boundingBox();
    assert.ok(y > 0 && y + height <= SCREEN.height, `a button at ${y}`);
  }
}

/** The phone at azimuth and elevation (degrees) about a point, looking at it. */
function around(azimuth, elevation, distance = 0.45, middle = MIDDLE) {
  const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
  // In the room +Y is up; the page's +X is the room's, its +Y the room's -Z.
  const out = [Math.cos(a) * Math.cos(e), Math.sin(e), -Math.sin(a) * Math.cos(e)];
  const eye = out.map((value, i) => middle[i] + distance * value);
  // First look down by the elevation (about X), then about the upward axis: at rest the phone looks along -Z.
  const turnY = a + Math.PI / 2;
  const [cy, sy, cx, sx] = [Math.cos(turnY / 2), Math.sin(turnY / 2), Math.cos(-e / 2), Math.sin(-e / 2)];
  return { eye, turn: [cy * sx, sy * cx, -sy * sx, cy * cx] };
}

/** The pose that the page should tell: rows of (3, 4), the object's frame, +Z up, from the room's. */
function poseInObject({ eye, turn: [x, y, z, w] }) {
  const axes = [
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
  const turned = ([a, b, c]) => [a, -c, b];
  // The object stands on the origin: its middle is 0.4 of its size above.
  const place = turned(eye.map((value, i) => value - MIDDLE[i])).map((value, i) => value + (i === 2 ? 0.4 * OBJECT_M : 0));
  const columns = [...axes.map(turned), place];
  return [0, 1, 2].flatMap((row) => columns.map((column) => column[row]));
}

/** Where someone goes who is told so. */
function follow(words, { azimuth, elevation }) {
  const [, turn, side] = /(\d+)° to the (right|left)/.exec(words) ?? [];
  const [, size, way] = /(slightly |much )?(higher|lower)/.exec(words) ?? [];
  const rise = way === undefined ? 0 : { "slightly ": 6, "much ": 40 }[size] ?? 20;
  const around = words.includes("opposite") ? 180 : Number(turn ?? 0) * (side === "left" ? -1 : 1);
  return { azimuth: azimuth + around, elevation: elevation + (way === "lower" ? -rise : rise) };
}

describe("a capture by the tracking of an emulated phone, with an emulated camera picture", () => {
  let browser;
  const reached = [];
  before(async () => {
    browser = await browse({ viewport: SCREEN });
    await emulate(browser.page);
  });
  after(() => browser.close());

  test("the object is placed by aiming at it from two sides; what does not tell is said", async () => {
    const { page } = browser;
    await setUp(page);
    await page.getByLabel(/a mug/).check();
    await page.getByRole("button", { name: "Start in AR" }).waitFor();
    await inspect(page, "xr-setup", SCREEN);
    await begin(page);
    await page.getByRole("heading", { name: "Aim at the object" }).waitFor();
    await idle(page);
    await move(page, around(0, 30));
    await inspect(page, "xr-placing", SCREEN);
    await isClearInTheMiddle(page, ".cross");
    await aim(page);
    await page.getByRole("heading", { name: "once more" }).waitFor();
    await move(page, around(8, 30));
    await aim(page);
    await notice(page).filter({ hasText: "Step further round" }).waitFor();
    await move(page, around(90, 30, 0.45, [MIDDLE[0], MIDDLE[1] + 0.2, MIDDLE[2]]));
    await aim(page);
    await notice(page).filter({ hasText: "do not meet" }).waitFor();
    await move(page, around(90, 45));
    await aim(page);
    await page.locator(".say h1", { hasText: /Move|You are there|Hold still/ }).waitFor();
  });

  test("who follows the words arrives, and the shutter fires by itself", async () => {
    const { page } = browser;
    let place = { azimuth: 90, elevation: 45 };
    for (let step = 0; step < 40 && (await shots(page)) < 3; step += 1) {
      const before = await shots(page);
      const words = (await page.locator(".say h1").textContent()) ?? "";
      if (words.startsWith("Move")) {
        place = follow(words, place);
        await move(page, around(place.azimuth, place.elevation));
      }
      // There, the shutter waits 0.4 s.
      const fired = page.locator(".strip li").nth(before).waitFor({ timeout: 2500 }).then(() => true, () => false);
      if (/^(Hold still|You are there)/.test((await page.locator(".say h1").textContent()) ?? "") && (await fired)) {
        reached.push(around(place.azimuth, place.elevation));
        await idle(page);
      }
    }
    assert.equal(await shots(page), 3);
    assert.equal(reached.length, 3);
  });

  test("lost tracking is told, and no photo is taken without a pose", async () => {
    const { page } = browser;
    await page.getByLabel("Take photos by itself").uncheck();
    await page.evaluate(() => { globalThis.phone.isLost = true; });
    await page.locator('[data-hint="lost"]').filter({ hasText: "Tracking is lost" }).waitFor();
    await page.getByRole("button", { name: "Take a photo now" }).click();
    await notice(page).filter({ hasText: "The photo was not taken" }).waitFor();
    assert.equal(await shots(page), 3);
    await page.evaluate(() => { globalThis.phone.isLost = false; });
    await page.locator('[data-hint="lost"]').waitFor({ state: "detached" });
  });

  test("photos by hand; the screen suits eyes, ears and small phones", async () => {
    const { page } = browser;
    for (const place of [around(200, 20), around(-75, 62, 0.6), { ...around(33, 50), turn: around(36, 47).turn }]) {
      await move(page, place);
      const before = await shots(page);
      await page.getByRole("button", { name: "Take a photo now" }).click();
      await page.locator(".strip li").nth(before).waitFor();
      await idle(page);
      reached.push(place);
    }
    await inspect(page, "xr-camera", SCREEN);
    await isClearInTheMiddle(page, ".aim");
  });

  test("when the system ends AR, everything is kept; the saved poses are the phone's", async (t) => {
    const { page } = browser;
    await page.evaluate(() => globalThis.phone.session.end());
    await notice(page).filter({ hasText: "AR has ended. All 6 photos are kept." }).waitFor();
    assert.equal(await page.locator(".card").count(), 6);
    const files = readZip(await save(page, "xr.zip"));
    const record = JSON.parse(files.get("my-object/capture.json"));
    assert.deepEqual(record.subject, { kind: "camera", source: "webxr" });
    assert.ok(Math.abs(record.lens.fy - SCREEN.height / 2 / Math.tan(FOV_Y_RAD / 2)) < 1e-3 && Math.abs(record.lens.fx - record.lens.fy) < 1e-3, JSON.stringify(record.lens));
    let worst = 0;
    for (const [index, photo] of record.photos.entries()) {
      assert.equal(photo.source, "webxr");
      const truth = poseInObject(reached[index]);
      worst = Math.max(worst, ...photo.pose.map((value, i) => Math.abs(value - truth[i])));
    }
    t.diagnostic(`largest difference of ${record.photos.length} poses, rotation or metres: ${worst.toExponential(1)}`);
    assert.ok(worst < 1e-3, `${worst}`);
    assert.match(files.get("my-object/README.md").toString(), /Phone tracking \(WebXR\): a few centimetres/);
    const picture = files.get("my-object/images/frame_00001.jpg").toString("base64");
    const corners = await page.evaluate(cornersOf, picture);
    assert.deepEqual(corners.size, [SCREEN.width, SCREEN.height]);
    assert.ok(corners.upperLeft[0] > 200 && corners.upperLeft[1] < 60, `upper left ${corners.upperLeft}`);
    assert.ok(corners.lowerLeft[1] > 120, `lower left ${corners.lowerLeft}`);
    await page.getByRole("button", { name: "Take more photos" }).click();
    await page.getByText("no photo can be added").waitFor();
    assert.equal(await page.getByRole("button", { name: /^Go on with/ }).count(), 0);
    assert.deepEqual(browser.problems, []);
  });

  test("when the phone loses its place for good, AR ends, and the old capture is still there", async () => {
    const { page } = browser;
    await begin(page);
    await page.getByRole("heading", { name: "Aim at the object" }).waitFor();
    await idle(page);
    await page.evaluate(() => globalThis.phone.device.recenter());
    await notice(page).filter({ hasText: "lost its place" }).waitFor();
    await page.getByRole("heading", { name: "1. Print the board" }).waitFor();
    assert.equal(await page.evaluate(() => globalThis.phone.device.activeSession ?? null), null);
    await page.reload();
    await page.getByText("6 photos").waitFor();
  });
});

for (const [what, options, words] of [
  ["AR without pictures is told apart, and the board is advised", { features: ["viewer", "local", "dom-overlay"] }, /no pictures there\. Print the board/],
  ["refused AR is said", { refusal: "NotAllowedError" }, /AR was refused\. Allow/],
  ["AR without room for the page's controls is said", { features: ["viewer", "local", "camera-access"] }, /AR could not be started|cannot show this page in AR/],
]) {
  test(what, async () => {
    const { page, close } = await browse({ viewport: SCREEN });
    try {
      await emulate(page, options);
      await setUp(page);
      await begin(page);
      await notice(page).filter({ hasText: words }).waitFor();
      await page.getByRole("heading", { name: "1. Print the board" }).waitFor();
      assert.equal(await page.evaluate(() => globalThis.phone.device.activeSession ?? null), null);
      assert.ok(await page.getByRole("button", { name: "Start the camera" }).isEnabled());
    } finally {
      await close();
    }
  });
}

test("a browser without AR does not offer it", async () => {
  const { page, close } = await browse({ viewport: SCREEN });
  try {
    await setUp(page);
    await page.getByText("No printer?").waitFor();
    await page.waitForTimeout(300);
    assert.equal(await page.getByRole("button", { name: "Start in AR" }).count(), 0);
  } finally {
    await close();
  }
});

/** Runs in the page: two corners of a picture. */
async function cornersOf(picture) {
  const bytes = Uint8Array.from(atob(picture), (sign) => sign.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/jpeg" }));
  const drawing = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  drawing.drawImage(bitmap, 0, 0);
  const at = (y) => [...drawing.getImageData(10, y, 1, 1).data];
  return { size: [bitmap.width, bitmap.height], upperLeft: at(10), lowerLeft: at(bitmap.height - 10) };
}
