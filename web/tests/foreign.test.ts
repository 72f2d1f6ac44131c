import { describe, expect, it } from "vitest";
import { parsePolycam, parseRecord3d, parseTransforms } from "../src/worker/foreign.js";

const matrix = [[1, 0, 0, 0.5], [0, 0, -1, -3], [0, 1, 0, 0.2], [0, 0, 0, 1]];
const frame = { file_path: "./images/a.png", transform_matrix: matrix };
const file = { fl_x: 100, fl_y: 101, cx: 32, cy: 24, w: 64, h: 48, frames: [frame] };

describe("transforms.json", () => {
  it("is read: pose, lens, where the photo may lie", () => {
    const { frames, notes } = parseTransforms(file);
    expect(frames[0]?.paths).toEqual(["images/a.png"]);
    expect([...(frames[0]?.pose ?? [])].map((v) => +v.toFixed(4))).toEqual(matrix.slice(0, 3).flat());
    expect(frames[0]?.lens(64, 48)).toEqual({ width: 64, height: 48, fx: 100, fy: 101, cx: 32, cy: 24 });
    expect(notes).toEqual([]);
  });

  it("may describe larger photos than there are, a field of view, and names without extensions", () => {
    expect(parseTransforms(file).frames[0]?.lens(32, 24).fx).toBe(50);
    const angle = parseTransforms({ camera_angle_x: 1, frames: [{ ...frame, file_path: "train/r_0" }] }).frames[0];
    expect(angle?.lens(200, 200).fx).toBeCloseTo(100 / Math.tan(0.5));
    expect(angle?.paths).toContain("train/r_0.png");
  });

  it("notes what has no effect", () => {
    expect(parseTransforms({ ...file, k1: 0.1, applied_transform: [] }).notes).toHaveLength(2);
    expect(parseTransforms({ ...file, orientation_override: "none" }).keepsZUp).toBe(true);
  });

  it.each<[string, Record<string, unknown>]>([
    ["no list", { fl_x: 1 }],
    ["lists no photos", { frames: [] }],
    ["file_path", { ...file, frames: [{ transform_matrix: matrix }] }],
    ["transform_matrix", { ...file, frames: [{ file_path: "a.png" }] }],
    ["4 rows", { ...file, frames: [{ ...frame, transform_matrix: [[1, 0], [0, 1]] }] }],
    ["not a rotation", { ...file, frames: [{ ...frame, transform_matrix: matrix.map((row) => row.map((v) => 2 * v)) }] }],
    ["mirrored", { ...file, frames: [{ ...frame, transform_matrix: [[-1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0]] }] }],
    ["fl_x", { frames: [frame] }],
    ["no number", { ...file, cx: "left" }],
    ["no pinhole", { ...file, camera_model: "OPENCV_FISHEYE" }],
  ])("is refused in words: %s", (words, content) => expect(() => parseTransforms(content)).toThrow(words));

  it("refuses a photo of other proportions when it is read", () => {
    expect(() => parseTransforms(file).frames[0]?.lens(64, 64)).toThrow("64 x 64");
  });
});

it("Record3D's metadata: K by columns, quaternions", () => {
  const { frames, origin } = parseRecord3d({ w: 10, h: 20, K: [9, 0, 0, 0, 8, 0, 5, 10, 1], poses: [[0, 0, Math.SQRT1_2, Math.SQRT1_2, 1, 2, 3]] });
  expect(origin).toBe("Record3D");
  const pose = frames[0]?.pose ?? [];
  expect([pose[1], pose[4], pose[3], pose[7], pose[11]].map((v) => +(v ?? 0).toFixed(5))).toEqual([-1, 1, 1, 2, 3]);
  expect(frames[0]?.lens(20, 40)).toMatchObject({ fx: 18, fy: 16, cx: 10, cy: 20 });
  expect(() => parseRecord3d({ poses: [] })).toThrow("not Record3D");
});

it("Polycam's raw export: +Y up becomes +Z up", () => {
  const content = Object.fromEntries([
    ...[[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3]].flatMap((row, r) => row.map((value, c) => [`t_${r}${c}`, value])),
    ...Object.entries({ width: 8, height: 6, fx: 5, fy: 5, cx: 4, cy: 3 }),
  ]);
  const { frames, keepsZUp } = parsePolycam([{ path: "x/keyframes/corrected_cameras/12.json", content }]);
  expect(frames[0]?.paths[0]).toBe("keyframes/corrected_images/12.jpg");
  // The camera's upward axis, ARKit's y, is the world's z.
  expect([frames[0]?.pose[1], frames[0]?.pose[5], frames[0]?.pose[9]]).toEqual([0, 0, 1]);
  expect([frames[0]?.pose[3], frames[0]?.pose[7], frames[0]?.pose[11]]).toEqual([3, 1, 2]);
  expect(keepsZUp).toBe(true);
});
