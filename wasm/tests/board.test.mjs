// The tag board in Node: what is drawn to print is found again in a picture of it.

import { deepEqual, equal, match, ok } from "node:assert/strict";
import { test } from "node:test";

import { thrown, vantage } from "./package.mjs";

const { BoardTracker, frameQuality } = vantage;

const PX_PER_MM = 2.5;

/** The drawing as a camera sees it that hangs over the middle of the sheet: luma. */
function picture(svg) {
  const [width, height] = svg.match(/viewBox="0 0 (\S+) (\S+)"/).slice(1).map((mm) => Math.floor(mm * PX_PER_MM));
  const luma = new Uint8Array(width * height).fill(220);
  for (const [, x, y, w, h] of svg.matchAll(/M(\S+) (\S+)h(\S+)v(\S+)h-\S+z/g)) {
    const [left, top] = [x, y].map((mm) => Math.round(mm * PX_PER_MM));
    const [right, bottom] = [+x + +w, +y + +h].map((mm) => Math.round(mm * PX_PER_MM));
    for (let row = top; row < bottom; row++) luma.fill(30, row * width + left, row * width + right);
  }
  return { luma, width, height };
}

test("a board is drawn, found, and the camera placed above it", () => {
  const tracker = new BoardTracker({ columns: 4, rows: 3, tagSizeM: 0.04, gapM: 0.012, firstId: 30 });
  const { luma, width, height } = picture(tracker.svg("a4"));
  equal(tracker.track(luma, width, height).intrinsicsSource, "assumed");
  const focalPx = 900;
  tracker.setIntrinsics(focalPx, width / 2, height / 2);
  const seen = tracker.track(luma, width, height);
  deepEqual(seen.tags.map(({ id }) => id), [30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 41]);
  ok(seen.tags.every(({ corners }) => corners instanceof Float32Array && corners.length === 8));
  deepEqual([seen.intrinsicsSource, seen.focalPx, seen.tagsUsed, seen.isAmbiguous], ["given", focalPx, 12, false]);
  // Straight above, the picture's top towards the far edge.
  const above = focalPx / PX_PER_MM / 1000;
  const expected = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, above];
  ok(seen.pose.every((value, i) => Math.abs(value - expected[i]) < 0.003), `${seen.pose}`);
  ok(seen.rmsPx < 0.5);
  equal(tracker.calibrate(), undefined);
});

test("a frame without a board has no pose, and its quality is told", () => {
  const seen = new BoardTracker().track(new Uint8ClampedArray(64 * 48).fill(7), 64, 48);
  deepEqual(seen.tags, []);
  ok(!("pose" in seen) && !("rmsPx" in seen) && !("isAmbiguous" in seen));
  const quality = frameQuality(new Uint8Array(64 * 48).fill(7), 64, 48);
  deepEqual(quality, { sharpness: 0, meanLuma: 7, darkShare: 1, brightShare: 0 });
});

test("what cannot be is refused in a sentence", () => {
  const refusals = [
    [() => new BoardTracker(3), /sizes must be an object/],
    [() => new BoardTracker({ columns: 0 }), /at least one column/],
    [() => new BoardTracker({ columns: 2.5 }), /`columns` must be a whole number/],
    [() => new BoardTracker({ gapM: "wide" }), /`gapM` must be a number/],
    [() => new BoardTracker({ rows: 600 }), /there are 587/],
    [() => new BoardTracker({ columns: 9 }).svg("a4"), /needs 460 x 210 mm/],
    [() => new BoardTracker().svg("a5"), /`page` must be/],
    [() => new BoardTracker().track(new Uint8Array(4), 3, 2), /4 bytes of luma where its size needs 6/],
    [() => new BoardTracker().track([1, 2], 2, 1), /`luma` must be a Uint8Array/],
    [() => new BoardTracker().setIntrinsics(0, 1, 1), /focal length must be positive/],
    [() => frameQuality(new Uint8Array(4), 0, 4), /0 x 4 pixels/],
  ];
  for (const [call, sentence] of refusals) {
    const error = thrown(call);
    equal(error?.code, "bad-argument", `${call}`);
    match(error.message, sentence);
  }
});
