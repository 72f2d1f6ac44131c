// Poses and directions, with the core's conventions: right-handed world, +Z up, lengths in the
// capture's own unit, angles in radians. A pose is `world_from_camera` with OpenGL camera axes
// (right, up, back; the camera looks along -Z), 12 numbers: the rows of a (3, 4) matrix.

export type Vec3 = readonly [number, number, number];
export type Pose = ArrayLike<number>;

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const distance = (a: Vec3, b: Vec3): number => length(subtract(a, b));
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** The vector at unit length; the zero vector stays zero. */
export function unit(a: Vec3): Vec3 {
  const norm = length(a);
  return norm > 0 ? scale(a, 1 / norm) : [0, 0, 0];
}

/** The angle between two directions, in [0, pi]. */
export function angleBetween(a: Vec3, b: Vec3): number {
  return Math.atan2(length(cross(a, b)), dot(a, b));
}

const column = (pose: Pose, which: number, start: number): Vec3 => [
  pose[start + which] ?? Number.NaN,
  pose[start + 4 + which] ?? Number.NaN,
  pose[start + 8 + which] ?? Number.NaN,
];

/** The camera centre of pose `index` among rows of 12 numbers. */
export const position = (poses: Pose, index = 0): Vec3 => column(poses, 3, 12 * index);
export const right = (pose: Pose): Vec3 => column(pose, 0, 0);
export const up = (pose: Pose): Vec3 => column(pose, 1, 0);
export const back = (pose: Pose): Vec3 => column(pose, 2, 0);
export const forward = (pose: Pose): Vec3 => scale(back(pose), -1);

/** The 12 numbers of pose `index`. */
export function poseAt(poses: ArrayLike<number>, index: number): Float32Array {
  return Float32Array.from({ length: 12 }, (_, i) => poses[12 * index + i] ?? Number.NaN);
}

/** A pose from its camera centre and axes. */
export function fromAxes(centre: Vec3, x: Vec3, y: Vec3, z: Vec3): Float32Array {
  return Float32Array.of(
    x[0], y[0], z[0], centre[0],
    x[1], y[1], z[1], centre[1],
    x[2], y[2], z[2], centre[2],
  );
}

/** A pose at `eye` that looks at `target`, its top towards `sky`; straight above, +Y is the top. */
export function lookingAt(eye: Vec3, target: Vec3, sky: Vec3 = [0, 0, 1]): Float32Array {
  const behind = unit(subtract(eye, target));
  let aside = cross(sky, behind);
  if (dot(aside, aside) < 1e-6) aside = cross(Math.abs(sky[1]) > 0.9 ? [1, 0, 0] : [0, 1, 0], behind);
  const x = unit(aside);
  return fromAxes(eye, x, cross(behind, x), behind);
}

/** A point of the world in the camera's frame. */
export function toCamera(pose: Pose, point: Vec3): Vec3 {
  const out = subtract(point, position(pose));
  return [dot(right(pose), out), dot(up(pose), out), dot(back(pose), out)];
}

/** A pinhole, in pixels; the origin is the picture's upper left corner, y down. */
export type Lens = { width: number; height: number; fx: number; fy: number; cx: number; cy: number };

/** A lens with square pixels and a central principal point. */
export function lensOf(width: number, height: number, fovXRad: number): Lens {
  const focal = (0.5 * width) / Math.tan(0.5 * fovXRad);
  return { width, height, fx: focal, fy: focal, cx: 0.5 * width, cy: 0.5 * height };
}

/** The same field of view at another size in pixels. */
export function resized(lens: Lens, width: number, height: number): Lens {
  const [x, y] = [width / lens.width, height / lens.height];
  return { width, height, fx: lens.fx * x, fy: lens.fy * y, cx: lens.cx * x, cy: lens.cy * y };
}

/** Where a point in the camera's frame falls, in pixels; null behind the camera. */
export function project(lens: Lens, [x, y, z]: Vec3): [number, number] | null {
  return z < 0 ? [lens.cx - (lens.fx * x) / z, lens.cy + (lens.fy * y) / z] : null;
}

/** The angle of the rotation between two poses. */
export function turnBetween(a: Pose, b: Pose): number {
  const trace = dot(right(a), right(b)) + dot(up(a), up(b)) + dot(back(a), back(b));
  return Math.acos(Math.max(-1, Math.min(1, (trace - 1) / 2)));
}

export const degrees = (radians: number): number => (radians * 180) / Math.PI;
export const radians = (deg: number): number => (deg * Math.PI) / 180;
