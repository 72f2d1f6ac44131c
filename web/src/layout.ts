// Where the object stands in the capture's own coordinates, and the way to the planner's, where the
// object fills the unit sphere around the origin, +Z is up and cameras stand at distance 3.
//
// `estimate` finds middle, size and upward direction from cameras alone, as `vantage plan --photos`
// does (lab/src/photos/layout.rs): the point nearest to all optical axes with Cauchy's weights, the
// largest sphere there that half of the photos could show whole, the mean of the upward directions.

import {
  type Lens, type Pose, type Vec3,
  add, back, cross, distance, dot, forward, fromAxes, length, lookingAt, position, project, right, scale,
  subtract, toCamera, unit, up,
} from "./geometry.js";

/** Distance of the planner's cameras from the object's middle, in radii of its bounding sphere. */
export const DISTANCE = 3;
/** Horizontal field of view of the planner's cameras: at that distance the sphere just fits. */
export const FOV_X_RAD = 0.6911112;

export type Layout = {
  /** The object's middle, in the capture's coordinates. */
  centre: Vec3;
  /** The radius of the sphere that holds the object. */
  radius: number;
  /** How far from the middle photos are taken. */
  distance: number;
  /** The upward direction, unit length. */
  up: Vec3;
};

/** The planner's own coordinates: what simulated captures use. */
export const PLAIN: Layout = { centre: [0, 0, 0], radius: 1, distance: DISTANCE, up: [0, 0, 1] };

/** The rows of the rotation that takes the layout's up to +Z by the shortest way. */
function planFromCapture(layout: Layout): [Vec3, Vec3, Vec3] {
  const [a, b, c] = layout.up;
  if (c > 1 - 1e-12) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  if (c < -1 + 1e-9) return [[1, 0, 0], [0, -1, 0], [0, 0, -1]];
  // Rodrigues' formula about up x Z = (b, -a, 0).
  const k = 1 / (1 + c);
  return [
    [1 - a * a * k, -a * b * k, -a],
    [-a * b * k, 1 - b * b * k, -b],
    [a, b, c],
  ];
}

/** The direction, in the planner's coordinates, of a point as seen from the object's middle. */
export function directionOf(layout: Layout, point: Vec3): Vec3 {
  const [x, y, z] = planFromCapture(layout);
  const out = unit(subtract(point, layout.centre));
  return [dot(x, out), dot(y, out), dot(z, out)];
}

/** The planner's camera that stands for a camera of the capture: same direction, looks at the middle. */
export function toPlan(layout: Layout, pose: Pose): Float32Array {
  return lookingAt(scale(directionOf(layout, position(pose)), DISTANCE), [0, 0, 0]);
}

/** The capture's pose for one of the planner's: the same direction at the capture's distance. */
export function fromPlan(layout: Layout, pose: Pose): Float32Array {
  const [x, y, z] = planFromCapture(layout);
  const turn = (v: Vec3): Vec3 => add(add(scale(x, v[0]), scale(y, v[1])), scale(z, v[2]));
  const out = turn(position(pose));
  const eye = add(layout.centre, scale(out, layout.distance / DISTANCE));
  return fromAxes(eye, turn(right(pose)), turn(up(pose)), turn(back(pose)));
}

/** A camera that took a photo. */
export type Camera = { pose: Pose; lens: Lens };

/** Why cameras do not tell where the object is; a sentence. */
export class LayoutError extends Error {}

/** Axes count fully up to about this many times the middle distance of axes from the centre. */
const OUTLIER = 3;
/** Below this the axes are taken for parallel: the square of the sine of one degree. */
const LEAST_SPREAD = 3e-4;

/** The layout of photos taken around an object. */
export function estimate(cameras: readonly Camera[], keepsZUp = false): Layout {
  const centre = middle(cameras);
  const sky: Vec3 = keepsZUp ? [0, 0, 1] : upward(cameras);
  const away = median(cameras.map(({ pose }) => distance(position(pose), centre)));
  const framed = cameras.map((camera) => frames(camera, centre)).filter((r) => r !== null);
  if (framed.length === 0 || !(away > 0)) {
    throw new LayoutError("No photo has the object in its middle: the cameras do not look at one object.");
  }
  return { centre, radius: median(framed), distance: away, up: sky };
}

function middle(cameras: readonly Camera[]): Vec3 {
  let weights = cameras.map(() => 1);
  let centre: Vec3 = [0, 0, 0];
  for (let round = 0; round < 30; round += 1) {
    // sum w (I - d dT)(centre - eye) = 0, a symmetric system of three.
    const m = [0, 0, 0, 0, 0, 0, 0, 0, 0];
    const r = [0, 0, 0];
    let total = 0;
    cameras.forEach(({ pose }, index) => {
      const weight = weights[index] ?? 0;
      const d = forward(pose);
      const eye = position(pose);
      total += weight;
      for (let i = 0; i < 3; i += 1) {
        for (let j = 0; j < 3; j += 1) {
          const across = (i === j ? 1 : 0) - (d[i] ?? 0) * (d[j] ?? 0);
          m[3 * i + j] = (m[3 * i + j] ?? 0) + weight * across;
          r[i] = (r[i] ?? 0) + weight * across * (eye[j] ?? 0);
        }
      }
    });
    const rows: [Vec3, Vec3, Vec3] = [row(m, 0), row(m, 3), row(m, 6)];
    const determinant = dot(rows[0], cross(rows[1], rows[2]));
    // The determinant of the mean projection is at most its least eigenvalue.
    if (!(total > 0) || determinant / total ** 3 < LEAST_SPREAD * 0.5) {
      throw new LayoutError(
        "All photos look the same way, so it cannot be told where the object is: take some from other sides.",
      );
    }
    const inverse = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])] as const;
    const right: Vec3 = row(r, 0);
    const next = scale(
      add(add(scale(inverse[0], right[0]), scale(inverse[1], right[1])), scale(inverse[2], right[2])),
      1 / determinant,
    );
    const moved = distance(next, centre);
    centre = next;
    const misses = cameras.map(({ pose }) => length(cross(forward(pose), subtract(next, position(pose)))));
    const typical = median(misses);
    const first = cameras[0];
    if (!(typical > 0) || !first || moved <= 1e-9 * distance(next, position(first.pose))) break;
    weights = cameras.map(({ pose }, index) => {
      const isAhead = dot(forward(pose), subtract(next, position(pose))) > 0;
      return isAhead ? 1 / (1 + ((misses[index] ?? 0) / (OUTLIER * typical)) ** 2) : 0;
    });
  }
  return centre;
}

const row = (m: readonly number[], start: number): Vec3 => [m[start] ?? 0, m[start + 1] ?? 0, m[start + 2] ?? 0];

/** The mean of the cameras' upward directions or, of cameras held on their side, of the rightward. */
function upward(cameras: readonly Camera[]): Vec3 {
  const mean = (axis: (pose: Pose) => Vec3): Vec3 =>
    scale(cameras.map(({ pose }) => axis(pose)).reduce(add, [0, 0, 0]), 1 / cameras.length);
  const [upright, sideways] = [mean(up), mean(right)];
  if (length(upright) >= length(sideways) && length(upright) > 0.3) return unit(upright);
  const aside = unit(sideways);
  const axes: Vec3[] = [[0, 0, 1], [0, 1, 0]];
  const known = axes.find((axis) => Math.abs(dot(aside, axis)) > 0.8);
  if (!known) throw new LayoutError("The photos do not agree which way is up.");
  return scale(known, Math.sign(dot(aside, known)));
}

/** The radius of the largest sphere at a point that the photo could show whole. */
function frames({ pose, lens }: Camera, point: Vec3): number | null {
  const place = project(lens, toCamera(pose, point));
  if (!place || place[0] < 0 || place[1] < 0 || place[0] > lens.width || place[1] > lens.height) return null;
  const sine = (focal: number, side: number): number => (0.5 * side) / Math.hypot(focal, 0.5 * side);
  return distance(position(pose), point) * Math.min(sine(lens.fx, lens.width), sine(lens.fy, lens.height));
}

/** The middle value; of an even number, the upper of the two; NaN of none. */
export function median(values: readonly number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? Number.NaN;
}
