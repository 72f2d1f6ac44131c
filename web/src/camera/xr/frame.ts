// A WebXR view in this page's conventions. WebXR's spaces are right-handed, metric, +Y up; a view's
// axes are OpenGL's already (right, up, back). Matrices come as 16 numbers, column by column.

import { type Lens, type Vec3, fromAxes, subtract } from "../../geometry.js";

/** A direction or point with +Y up, turned by a quarter about X so that +Z is up. */
export const zUp = ([x, y, z]: Vec3): Vec3 => [x, -z, y];

/** `world_from_camera` of a view's transform; `origin` is the world's, in the session's space, +Z up. */
export function poseOf(matrix: ArrayLike<number>, origin: Vec3): Float32Array {
  const column = (which: number): Vec3 =>
    zUp([matrix[4 * which] ?? Number.NaN, matrix[4 * which + 1] ?? Number.NaN, matrix[4 * which + 2] ?? Number.NaN]);
  return fromAxes(subtract(column(3), origin), column(0), column(1), column(2));
}

/**
 * The lens of a picture that fills a view, from the view's projection matrix (OpenGL's, column by
 * column): W3C's raw-camera-access draft, "obtaining camera intrinsics", with y down. Skew, which the
 * draft allows and cameras of phones do not have, is left out.
 */
export function lensOfProjection(projection: ArrayLike<number>, width: number, height: number): Lens {
  const p = (index: number): number => projection[index] ?? Number.NaN;
  return {
    width, height,
    fx: (width / 2) * p(0), fy: (height / 2) * p(5),
    cx: (width / 2) * (1 - p(8)), cy: (height / 2) * (1 + p(9)),
  };
}
