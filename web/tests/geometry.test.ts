import { describe, expect, it } from "vitest";
import { type Vec3, distance, forward, lensOf, lookingAt, position, project, right, toCamera, turnBetween, up } from "../src/geometry.js";
import { DISTANCE, FOV_X_RAD, type Layout, LayoutError, directionOf, estimate, fromPlan, toPlan } from "../src/layout.js";
import { colmapPose, matrix4, quaternion } from "../src/worker/files.js";
import { way } from "../src/words.js";

const near = (a: Vec3, b: Vec3): void => expect(distance(a, b)).toBeLessThan(1e-5);

describe("poses", () => {
  it("look at what they should, with the top upwards", () => {
    const pose = lookingAt([3, 0, 0], [0, 0, 0]);
    near(forward(pose), [-1, 0, 0]);
    near(up(pose), [0, 0, 1]);
    near(right(pose), [0, 1, 0]);
    expect(turnBetween(pose, lookingAt([0, 3, 0], [0, 0, 0]))).toBeCloseTo(Math.PI / 2);
  });

  it("project as the core does: half a field of view ahead is the edge", () => {
    const lens = lensOf(640, 480, 0.7);
    expect(project(lens, [Math.tan(0.35), 0, -1])?.[0]).toBeCloseTo(640);
    expect(project(lens, [0, 0, 1])).toBeNull();
    near(toCamera(lookingAt([0, -2, 0], [0, 0, 0]), [0, 0, 0.5]), [0, 0.5, -2]);
  });

  it("become quaternions and matrices that say the same", () => {
    for (const eye of [[3, 0, 0], [-1, 2, 2.5], [0.1, -0.2, 4], [-2, -2, -1]] as Vec3[]) {
      const pose = lookingAt(eye, [0.1, 0, 0.2]);
      const again = matrix4(pose).slice(0, 3).flat();
      again.forEach((value, index) => expect(value).toBeCloseTo(pose[index] ?? Number.NaN, 5));
      expect(Math.hypot(...quaternion(pose))).toBeCloseTo(1, 12);
    }
  });

  it("become COLMAP's: the target lies ahead, along +z, and up is -y", () => {
    const pose = lookingAt([2, -1, 1.5], [0, 0, 0]);
    const { rotation: [w, x, y, z], translation } = colmapPose(pose);
    // The world's origin is the translation itself: it is looked at from sqrt(7.25).
    near(translation, [0, 0, Math.sqrt(7.25)]);
    const zRow: Vec3 = [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
    near(zRow, forward(pose));
    const yRow: Vec3 = [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)];
    near(yRow, [-up(pose)[0], -up(pose)[1], -up(pose)[2]]);
  });
});

describe("layouts", () => {
  const layout: Layout = { centre: [1, 2, 3], radius: 0.2, distance: 0.7, up: [0, 0.6, 0.8] };

  it("take the planner's poses to the capture's and back", () => {
    for (const eye of [[3, 0, 0], [1, -2, 2], [-2, 2, 1]] as Vec3[]) {
      const plan = lookingAt(eye.map((v) => (v * DISTANCE) / Math.hypot(...eye)) as unknown as Vec3, [0, 0, 0]);
      const pose = fromPlan(layout, plan);
      expect(distance(position(pose), layout.centre)).toBeCloseTo(0.7, 5);
      near(position(toPlan(layout, pose)), position(plan));
      expect(turnBetween(pose, lookingAt(position(pose), layout.centre, layout.up))).toBeLessThan(1e-3);
    }
    near(directionOf(layout, [1, 2 + 0.6, 3 + 0.8]), [0, 0, 1]);
  });

  const around = (count: number, centre: Vec3): { pose: Float32Array; lens: ReturnType<typeof lensOf> }[] =>
    Array.from({ length: count }, (_, i) => {
      const turn = (2 * Math.PI * i) / count;
      const eye: Vec3 = [centre[0] + 2 * Math.cos(turn), centre[1] + 2 * Math.sin(turn), centre[2] + 0.3 + 0.1 * (i % 5)];
      return { pose: lookingAt(eye, centre), lens: lensOf(400, 300, 0.8) };
    });

  it("are found from the cameras alone, also where one looks elsewhere", () => {
    const centre: Vec3 = [4, -1, 0.5];
    const cameras = [...around(14, centre), { pose: lookingAt([9, 9, 9], [9, 12, 9]), lens: lensOf(400, 300, 0.8) }];
    const found = estimate(cameras);
    expect(distance(found.centre, centre)).toBeLessThan(0.02);
    expect(found.up[2]).toBeGreaterThan(0.98);
    // The largest sphere that a picture of 300 of 400 pixels shows whole.
    const half = Math.atan(0.75 * Math.tan(0.4));
    expect(found.radius / found.distance).toBeCloseTo(Math.sin(half), 1);
  });

  it("are refused where all cameras look the same way", () => {
    const cameras = [0, 1, 2, 3].map((x) => ({ pose: lookingAt([x, -3, 0], [x, 0, 0]), lens: lensOf(64, 64, FOV_X_RAD) }));
    expect(() => estimate(cameras)).toThrow(LayoutError);
  });
});

describe("ways", () => {
  const towards = (azimuth: number, elevation: number): Vec3 => {
    const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
    return [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
  };
  it.each([
    [towards(0, 10), towards(-30, 18), "30° to the left, slightly higher"],
    [towards(170, 10), towards(-170, 10), "20° to the right"],
    [towards(0, 60), towards(178, 10), "to the opposite side, much lower"],
    [towards(0, 20), towards(0, 20), "right here"],
    [towards(0, 20), towards(0, 80), "to nearly straight above"],
  ])("%#: are those of who faces the object", (from, to, words) => expect(way(from, to)).toBe(words));
});
