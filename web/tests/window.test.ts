import { expect, it } from "vitest";
import { back, distance, fromAxes, lensOf, lookingAt, position, project, right, scale, toCamera, up } from "../src/geometry.js";
import { FOV_X_RAD, PLAIN } from "../src/layout.js";
import { WINDOW, cut } from "../src/window.js";

/** A photo of a white disc of the unit sphere's size on black, by a lens and a pose. */
function photo(pose: Float32Array, size: number, fov: number): { data: Uint8ClampedArray; width: number; height: number } {
  const lens = lensOf(size, size, fov);
  const data = new Uint8ClampedArray(4 * size * size).fill(255);
  const away = distance(position(pose), [0, 0, 0]);
  const middle = project(lens, toCamera(pose, [0, 0, 0])) ?? [0, 0];
  const reach = (lens.fx * 0.5) / away;
  for (let y = 0; y < size; y += 1) {
    for (let x = 0; x < size; x += 1) {
      const isIn = Math.hypot(x + 0.5 - middle[0], y + 0.5 - middle[1]) < reach;
      data.fill(isIn ? 255 : 0, 4 * (y * size + x), 4 * (y * size + x) + 3);
    }
  }
  return { data, width: size, height: size };
}

const level = (rgb: Uint8Array, x: number, y: number): number => rgb[3 * (y * WINDOW + x)] ?? -1;
const width = (rgb: Uint8Array): number => Array.from({ length: WINDOW }, (_, x) => level(rgb, x, WINDOW / 2)).filter((v) => v > 127).length;

it("of a photo taken as in training is the photo made smaller", () => {
  const pose = lookingAt([0, -3, 0], [0, 0, 0]);
  const { rgb, share } = cut(photo(pose, 256, FOV_X_RAD), lensOf(256, 256, FOV_X_RAD), pose, PLAIN);
  expect(share).toBe(1);
  expect(level(rgb, 32, 32)).toBe(255);
  expect(level(rgb, 2, 2)).toBe(0);
  // Half the unit sphere's radius at distance 3 is 0.5 / (3 tan(fov / 2)) of half the window.
  expect(width(rgb)).toBeCloseTo((WINDOW * 0.5) / (3 * Math.tan(FOV_X_RAD / 2)), -0.5);
});

it("shows the object in the middle and as large, however the camera was held", () => {
  const aimed = lookingAt([0, -5, 1], [0, 0, 0]);
  // Aimed beside the object, and held on its side.
  const off = lookingAt(position(aimed), [0.6, 0, 0.3]);
  const turned = fromAxes(position(off), up(off), scale(right(off), -1), back(off));
  const one = cut(photo(aimed, 400, 0.9), lensOf(400, 400, 0.9), aimed, PLAIN).rgb;
  const two = cut(photo(turned, 400, 0.9), lensOf(400, 400, 0.9), turned, PLAIN).rgb;
  expect(Math.abs(width(one) - width(two))).toBeLessThanOrEqual(2);
  expect(level(two, 32, 32)).toBe(255);
});

it("tells how little of the object a photo shows", () => {
  const pose = lookingAt([0, -3, 0], [2.2, 0, 0]);
  const { share } = cut(photo(pose, 64, FOV_X_RAD), lensOf(64, 64, FOV_X_RAD), pose, PLAIN);
  expect(share).toBeLessThan(0.2);
});

it("puts what is transparent on the grey that training had", () => {
  const pose = lookingAt([0, -3, 0], [0, 0, 0]);
  const clear = { data: new Uint8ClampedArray(4 * 64 * 64), width: 64, height: 64 };
  expect(level(cut(clear, lensOf(64, 64, FOV_X_RAD), pose, PLAIN).rgb, 10, 10)).toBe(128);
});

