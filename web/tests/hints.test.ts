import { describe, expect, it } from "vitest";
import { AutoShutter, type Reading, STEADY_MS, SharpnessMemory, guide, speed } from "../src/camera/hints.js";
import { standing } from "../src/camera/live-layout.js";
import { cameraWords } from "../src/camera/stream.js";
import { isDue } from "../src/camera/voice.js";
import { type Vec3, add, lensOf, lookingAt, scale } from "../src/geometry.js";
import { orientationPose } from "../src/camera/source.js";

const lens = lensOf(640, 480, 1);
const layout = standing(0.1, lens);
const stand = (azimuth: number, elevation: number, factor = 1): Float32Array => {
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  const out: Vec3 = [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
  return lookingAt(add(layout.centre, scale(out, factor * layout.distance)), layout.centre);
};
const fine: Reading = {
  source: "board", pose: stand(0, 30), lens, usualSharpness: 1, speedRadS: 0.1, isAmbiguous: false,
  quality: { sharpness: 1, meanLuma: 120, darkShare: 0.1, brightShare: 0.01 },
};
const names = (reading: Partial<Reading>): string[] => guide({ ...fine, ...reading }, stand(0, 30), layout).hints.map((hint) => hint.name);

describe("hints", () => {
  it("are none where all is well, and the camera is ready", () => {
    const found = guide(fine, stand(4, 30), layout);
    expect(found.hints).toEqual([]);
    expect(found.isReady).toBe(true);
  });

  it.each<[string, Partial<Reading>]>([
    ["lost", { pose: null }],
    ["fast", { speedRadS: 1 }],
    ["dark", { quality: { sharpness: 1, meanLuma: 20, darkShare: 0.2, brightShare: 0 } }],
    ["bright", { quality: { sharpness: 1, meanLuma: 240, darkShare: 0, brightShare: 0.5 } }],
    ["blurred", { quality: { sharpness: 0.2, meanLuma: 120, darkShare: 0, brightShare: 0 } }],
    ["close", { pose: stand(0, 30, 0.5) }],
    ["far", { pose: stand(0, 30, 2) }],
    ["aim", { pose: lookingAt([0.4, 0, 0.3], [0.1, 0.3, 0.3]) }],
    ["ambiguous", { isAmbiguous: true }],
  ])("tell of %s, and then nothing is ready", (name, reading) => {
    expect(names(reading)).toContain(name);
    expect(guide({ ...fine, ...reading }, stand(0, 30), layout).isReady).toBe(false);
  });
});

describe("the target", () => {
  it("lies on the side where to go, and in the middle once there", () => {
    // Who faces the object walks to the right where azimuths grow.
    expect(guide(fine, stand(40, 30), layout).target?.x).toBeGreaterThan(0.3);
    expect(guide(fine, stand(-40, 30), layout).target?.x).toBeLessThan(-0.3);
    expect(guide(fine, stand(0, 65), layout).target?.y).toBeLessThan(-0.3);
    const there = guide(fine, stand(1, 30), layout).target;
    expect(Math.hypot(there?.x ?? 1, there?.y ?? 1)).toBeLessThan(0.05);
  });

  it("has a place also on the far side", () => {
    const { target, isInZone } = guide(fine, stand(180, -30), layout);
    expect(Number.isFinite(target?.x) && Number.isFinite(target?.y)).toBe(true);
    expect(isInZone).toBe(false);
  });
});

describe("the auto-shutter", () => {
  it("waits until all was well for a while, and fires once for a target", () => {
    const shutter = new AutoShutter();
    expect(shutter.feed(true, 7, 0)).toBe(false);
    expect(shutter.feed(true, 7, STEADY_MS - 1)).toBe(false);
    expect(shutter.feed(true, 7, STEADY_MS)).toBe(true);
    expect(shutter.feed(true, 7, 3 * STEADY_MS)).toBe(false);
    expect(shutter.feed(true, 7, 5 * STEADY_MS)).toBe(false);
    shutter.feed(true, 8, 6 * STEADY_MS);
    expect(shutter.feed(true, 8, 7 * STEADY_MS)).toBe(true);
  });

  it("begins anew after a shake, and tries a failed shot again", () => {
    const shutter = new AutoShutter();
    shutter.feed(true, 1, 0);
    shutter.feed(false, 1, 100);
    expect(shutter.feed(true, 1, STEADY_MS)).toBe(false);
    expect(shutter.feed(true, 1, 2 * STEADY_MS)).toBe(true);
    shutter.again();
    shutter.feed(true, 1, 3 * STEADY_MS);
    expect(shutter.feed(true, 1, 4 * STEADY_MS)).toBe(true);
  });
});

it("usual sharpness is not known at once, and not drawn down by a few blurred frames", () => {
  const memory = new SharpnessMemory();
  expect(memory.usual()).toBeNull();
  for (let i = 0; i < 30; i += 1) memory.feed(i % 3 === 0 ? 0.1 : 1);
  expect(memory.usual()).toBe(1);
});

it("speed is that of the turn, however made", () => {
  expect(speed(stand(0, 30), stand(10, 30), layout, 0.5)).toBeCloseTo((2 * 8.66 * Math.PI) / 180, 1);
});

it("the orientation sensor's angles give a camera that looks at the object", () => {
  // Upright, screen to the south: alpha 0, beta 90. The rear camera looks north, +y.
  const pose = orientationPose({ alpha: 0, beta: 90, gamma: 0 }, 0, layout);
  expect(pose[3]).toBeCloseTo(0);
  expect(pose[7]).toBeCloseTo(-layout.distance);
  expect(pose[9]).toBeCloseTo(1); // the picture's top is up
});

it("every refusal of the camera has words that say what to do", () => {
  for (const name of ["NotAllowedError", "NotFoundError", "NotReadableError", "OddError"]) expect(cameraWords(name)).toMatch(/\.$/);
  expect(cameraWords("NotAllowedError")).toContain("Allow it");
});

it("a sentence is not repeated at once, and what is urgent comes sooner", () => {
  const last = { text: "Hold still.", at: 0 };
  expect(isDue(last, "Hold still.", true, 2000)).toBe(false);
  expect(isDue(last, "Too dark.", true, 1500)).toBe(true);
  expect(isDue(last, "Go left.", false, 1500)).toBe(false);
  expect(isDue(last, "Hold still.", false, 8000)).toBe(true);
});
