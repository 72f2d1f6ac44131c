import { describe, expect, it } from "vitest";
import { type Vec3, add, distance, forward, lookingAt, position, project, scale, subtract, toCamera, up } from "../src/geometry.js";
import { lensOfProjection, poseOf, zUp } from "../src/camera/xr/frame.js";
import { type Aim, aimOf, middleOf } from "../src/camera/xr/placing.js";
import { sessionWords } from "../src/camera/xr/session.js";

/** A rigid transform as WebXR writes it: columns of a rotation by `angle` about an axis, then the position. */
function transform([x, y, z]: Vec3, angle: number, [px, py, pz]: Vec3): number[] {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const k = 1 - c;
  return [
    c + x * x * k, y * x * k + z * s, z * x * k - y * s, 0,
    x * y * k - z * s, c + y * y * k, z * y * k + x * s, 0,
    x * z * k + y * s, y * z * k - x * s, c + z * z * k, 0,
    px, py, pz, 1,
  ];
}

describe("a view of WebXR", () => {
  it("at rest looks along +Y, its top along +Z, as high as it was", () => {
    const pose = poseOf(transform([0, 1, 0], 0, [0.1, 1.5, -0.4]), [0, 0, 0]);
    expect(position(pose).map((v) => Math.round(1e6 * v) / 1e6)).toEqual([0.1, 0.4, 1.5]);
    expect(distance(forward(pose), [0, 1, 0])).toBeLessThan(1e-6);
    expect(distance(up(pose), [0, 0, 1])).toBeLessThan(1e-6);
  });

  it("sees every point where it did before the world was turned and moved", () => {
    const origin: Vec3 = [0.3, -0.2, 0.7];
    const axis = scale([1, 2, -2], 1 / 3);
    const matrix = transform(axis, 0.9, [0.5, 1.2, 0.3]);
    const point: Vec3 = [-0.4, 0.2, -1.3];
    // Inverse of the transform, by hand: the rotation's columns are the axes.
    const from = subtract(point, [0.5, 1.2, 0.3]);
    const along = (c: number): number => [0, 1, 2].reduce((sum, i) => sum + (matrix[4 * c + i] ?? 0) * (from[i] ?? 0), 0);
    const seen = toCamera(poseOf(matrix, origin), subtract(zUp(point), origin));
    expect(distance(seen, [along(0), along(1), along(2)])).toBeLessThan(1e-6);
  });

  it("has the lens that its projection matrix draws with, off the middle too", () => {
    // OpenGL's frustum: left, right, bottom, top at distance 1.
    const [l, r, b, t, n, f] = [-0.4, 0.5, -0.3, 0.35, 1, 100];
    const projection = [
      (2 * n) / (r - l), 0, 0, 0, 0, (2 * n) / (t - b), 0, 0,
      (r + l) / (r - l), (t + b) / (t - b), -(f + n) / (f - n), -1, 0, 0, (-2 * f * n) / (f - n), 0,
    ];
    const lens = lensOfProjection(projection, 900, 650);
    // The frustum's corners are the picture's.
    const miss = (x: number, y: number, at: [number, number]): number => {
      const place = project(lens, [x, y, -1]);
      return place ? Math.hypot(place[0] - at[0], place[1] - at[1]) : Number.NaN;
    };
    expect(miss(l, t, [0, 0])).toBeLessThan(1e-6);
    expect(miss(r, b, [900, 650])).toBeLessThan(1e-6);
  });
});

describe("placing the object", () => {
  const middle: Vec3 = [0.2, -0.1, 0.8];
  const from = (azimuth: number, elevation: number, miss: Vec3 = [0, 0, 0]): Aim => {
    const out: Vec3 = [Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation)];
    return aimOf(lookingAt(add(middle, scale(out, 0.45)), add(middle, miss)));
  };

  it("finds the middle that both aims share, and half the error of one", () => {
    expect(distance(middleOf(from(0, 0.4), from(1.5, 0.7), 0.1), middle)).toBeLessThan(1e-6);
    expect(distance(middleOf(from(0, 0.4), from(1.5, 0.4, [0, 0, 0.02]), 0.1), middle)).toBeLessThan(0.012);
  });

  it.each<[string, Aim, RegExp]>([
    ["from nearly the same place", from(0.2, 0.4), /Step further round/],
    ["from straight opposite", { eye: subtract(middle, scale(from(0, 0.4).towards, -0.5)), towards: scale(from(0, 0.4).towards, -1) }, /straight opposite/],
    ["at something else", from(1.5, 0.4, [0, 0, 0.2]), /do not meet/],
    ["away from the object", { ...from(1.5, 0.4), towards: scale(from(1.5, 0.4).towards, -1) }, /do not meet/],
  ])("says what to do about a second aim %s", (_, second, words) => {
    expect(() => middleOf(from(0, 0.4), second, 0.1)).toThrow(words);
  });
});

it("every refusal of AR has words that say what to do", () => {
  for (const name of ["NotAllowedError", "NotSupportedError", "SecurityError", "InvalidStateError", ""]) {
    expect(sessionWords(name)).toMatch(/(again|instead|more)\b.*\.$/);
  }
});
