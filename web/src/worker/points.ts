// Coloured points on the surface that rendered photos show: what splatting starts from.

import { type Lens, type Pose, type Vec3, add, back, cross, dot, length, position, right, scale, subtract, unit, up } from "../geometry.js";
import type { Pixels } from "../window.js";

export type Point = { position: Vec3; colour: [number, number, number] };

/** Trainers look for several neighbours of each point. */
export const LEAST_POINTS = 100;

/**
 * About `wanted` points of one photo, spread evenly over the pixels that show the object: where the
 * pixel's ray meets the plane of its face (as lab/src/seen_points.rs has it).
 */
export function seen(
  pose: Pose, lens: Lens, faces: Uint32Array, triangles: Float32Array, photo: Pixels, wanted: number,
): Point[] {
  const shown = faces.reduce((sum, face) => sum + (face > 0 ? 1 : 0), 0);
  const stride = Math.max(1, Math.floor(shown / wanted));
  const [eye, x, y, z] = [position(pose), right(pose), up(pose), back(pose)];
  const points: Point[] = [];
  let count = 0;
  faces.forEach((id, place) => {
    if (id === 0) return;
    count += 1;
    if (count % stride !== 0) return;
    const [column, line] = [place % lens.width, Math.floor(place / lens.width)];
    const ray = subtract(
      subtract(scale(x, (column + 0.5 - lens.cx) / lens.fx), scale(y, (line + 0.5 - lens.cy) / lens.fy)), z,
    );
    const corner = (k: number): Vec3 => {
      const at = 9 * (id - 1) + 3 * k;
      return [triangles[at] ?? 0, triangles[at + 1] ?? 0, triangles[at + 2] ?? 0];
    };
    const a = corner(0);
    const normal = unit(cross(subtract(corner(1), a), subtract(corner(2), a)));
    const fall = dot(ray, normal);
    const away = dot(subtract(a, eye), normal) / fall;
    const point = add(eye, scale(ray, away));
    // Grazing rays and rounding may throw a point far off its small face.
    if (Math.abs(fall) < 0.05 || !(away > 0) || length(point) > 1.1) return;
    const u = Math.floor(((column + 0.5) * photo.width) / lens.width);
    const v = Math.floor(((line + 0.5) * photo.height) / lens.height);
    const at = 4 * (v * photo.width + u);
    points.push({ position: point, colour: [photo.data[at] ?? 0, photo.data[at + 1] ?? 0, photo.data[at + 2] ?? 0] });
  });
  return points;
}

/** The points, with grey ones added on a golden spiral that fills the object's sphere evenly. */
export function padded(points: readonly Point[], centre: Vec3, radius: number): Point[] {
  const count = Math.max(0, LEAST_POINTS - points.length);
  const goldenAngle = Math.PI * (3 - Math.sqrt(5));
  const filling = Array.from({ length: count }, (_, i): Point => {
    const height = 1 - (2 * (i + 0.5)) / count;
    const ring = Math.sqrt(1 - height * height);
    const out: Vec3 = [ring * Math.cos(i * goldenAngle), ring * Math.sin(i * goldenAngle), height];
    return { position: add(centre, scale(out, radius * Math.cbrt((i * 0.618034) % 1))), colour: [128, 128, 128] };
  });
  return [...points, ...filling];
}

/** Binary form for the store: x y z as float, r g b as float. */
export const pack = (points: readonly Point[]): Uint8Array =>
  new Uint8Array(Float32Array.from(points.flatMap((p) => [...p.position, ...p.colour])).buffer);

export function unpack(buffer: ArrayBuffer): Point[] {
  const v = new Float32Array(buffer.slice(0, buffer.byteLength - (buffer.byteLength % 24)));
  return Array.from({ length: v.length / 6 }, (_, i): Point => {
    const at = (k: number): number => v[6 * i + k] ?? 0;
    return { position: [at(0), at(1), at(2)], colour: [at(3), at(4), at(5)] };
  });
}

/** A binary PLY: x y z as float, red green blue as uchar, little endian. */
export function ply(points: readonly Point[]): Uint8Array {
  const header = new TextEncoder().encode(
    `ply\nformat binary_little_endian 1.0\nelement vertex ${points.length}\n` +
      "property float x\nproperty float y\nproperty float z\n" +
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
  );
  const bytes = new Uint8Array(header.length + 15 * points.length);
  bytes.set(header);
  const view = new DataView(bytes.buffer);
  points.forEach(({ position: p, colour }, index) => {
    const at = header.length + 15 * index;
    p.forEach((value, axis) => view.setFloat32(at + 4 * axis, value, true));
    bytes.set(colour, at + 12);
  });
  return bytes;
}
