// The built-in object: a toy steam engine on a piece of track, made of painted primitives. It has
// what makes views matter: a long body, a hollow cab, thin rods, a detailed and a plain side.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry, IcosahedronGeometry, LatheGeometry, Matrix4,
  SphereGeometry, TorusGeometry, Vector2, Vector3,
} from "three";

type Paint = (at: Vector3, normal: Vector3) => Color;

const colour = (hex: number): Color => new Color(hex);
const plain = (hex: number): Paint => () => colour(hex);

/** A number in [0, 1) that only the place decides. */
function hash(x: number, y: number, z: number): number {
  const value = Math.sin(x * 127.1 + y * 311.7 + z * 74.7) * 43758.5453;
  return value - Math.floor(value);
}

/** Two colours in patches. */
const speckled = (a: number, b: number, size: number): Paint => (at) =>
  colour(a).lerp(colour(b), hash(Math.round(at.x / size), Math.round(at.y / size), Math.round(at.z / size)));

/** Rings along x. */
const banded = (base: number, band: number, places: readonly number[], width: number): Paint => (at) =>
  places.some((place) => Math.abs(at.x - place) < width) ? colour(band) : colour(base);

class Model {
  private positions: number[] = [];
  private colours: number[] = [];

  add(shape: BufferGeometry, paint: Paint, at: [number, number, number], turn: [number, number, number] = [0, 0, 0]): this {
    const flat = shape.index ? shape.toNonIndexed() : shape;
    flat.applyMatrix4(new Matrix4().makeRotationX(turn[0]).premultiply(new Matrix4().makeRotationY(turn[1])).premultiply(new Matrix4().makeRotationZ(turn[2])));
    flat.translate(...at);
    const place = flat.getAttribute("position");
    const normals = flat.getAttribute("normal");
    for (let i = 0; i < place.count; i += 1) {
      const p = new Vector3().fromBufferAttribute(place, i);
      const tint = paint(p, new Vector3().fromBufferAttribute(normals, i));
      this.positions.push(p.x, p.y, p.z);
      this.colours.push(tint.r, tint.g, tint.b);
    }
    return this;
  }

  done(): BufferGeometry {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(this.positions), 3));
    geometry.setAttribute("color", new BufferAttribute(Float32Array.from(this.colours), 3));
    geometry.computeVertexNormals();
    return geometry;
  }
}

const GREEN = 0x2f6d4f;
const BLACK = 0x2a2c30;
const BRASS = 0xd2a03a;
const RED = 0xb33a2b;
const CREAM = 0xe9dcc0;

/** The engine as triangles with a colour at each corner; +Z up, in no particular size. */
export function steamEngine(): BufferGeometry {
  const model = new Model();
  const quarter = Math.PI / 2;
  const box = (x: number, y: number, z: number, parts: [number, number, number] = [1, 1, 1]): BoxGeometry =>
    new BoxGeometry(x, y, z, ...parts);

  // Track: a bed of gravel, sleepers, rails.
  model.add(box(5.6, 2.2, 0.16, [44, 16, 1]), speckled(0x8d8478, 0x5f584f, 0.1), [0, 0, 0.08]);
  for (let i = 0; i < 9; i += 1) model.add(box(0.26, 1.9, 0.1, [2, 14, 1]), speckled(0x6b4a2f, 0x4c3320, 0.14), [-2.4 + 0.6 * i, 0, 0.2]);
  for (const y of [-0.6, 0.6]) model.add(box(5.6, 0.09, 0.14, [12, 1, 1]), plain(0x9aa0a8), [0, y, 0.32]);

  // Frame, buffers and cowcatcher.
  model.add(box(4.3, 0.9, 0.2, [30, 4, 1]), banded(RED, CREAM, [-1.9, 1.9], 0.06), [0, 0, 0.98]);
  for (const y of [-0.42, 0.42]) model.add(new CylinderGeometry(0.13, 0.09, 0.3, 20), plain(BLACK), [2.3, y, 0.98], [0, 0, -quarter]);
  for (let i = -3; i <= 3; i += 1) model.add(box(0.06, 0.07, 0.62), plain(RED), [2.36, 0.13 * i, 0.66], [0, 0.5, 0]);

  // Wheels with spokes, and the rods that drive them on one side only.
  for (const [x, r] of [[-1.35, 0.46], [-0.3, 0.46], [0.75, 0.46], [1.65, 0.28]] as const) {
    for (const y of [-0.62, 0.62]) {
      model.add(new TorusGeometry(r - 0.05, 0.055, 6, 28), plain(BLACK), [x, y, 0.39 + r], [quarter, 0, 0]);
      model.add(new CylinderGeometry(0.1, 0.1, 0.16, 16), plain(BRASS), [x, y, 0.39 + r]);
      for (let spoke = 0; spoke < 6; spoke += 1) {
        model.add(box(2 * r - 0.1, 0.05, 0.05), plain(RED), [x, y, 0.39 + r], [0, (spoke * Math.PI) / 6, 0]);
      }
    }
  }
  model.add(box(2.3, 0.05, 0.1, [16, 1, 1]), speckled(0xb9bec6, 0x8f959d, 0.08), [-0.3, -0.74, 0.72]);
  model.add(new CylinderGeometry(0.2, 0.2, 0.62, 20), plain(GREEN), [1.55, -0.66, 1.0], [0, 0, quarter]);

  // Boiler with brass bands; chimney, dome, bell, lamp.
  model.add(new CylinderGeometry(0.52, 0.52, 2.5, 40, 22), banded(GREEN, BRASS, [-0.6, 0.1, 0.8, 1.4], 0.045), [0.55, 0, 1.62], [0, 0, quarter]);
  model.add(new CylinderGeometry(0.55, 0.55, 0.42, 40, 1), plain(BLACK), [1.95, 0, 1.62], [0, 0, quarter]);
  model.add(new TorusGeometry(0.36, 0.045, 6, 32), plain(BRASS), [2.17, 0, 1.62], [0, quarter, 0]);
  const chimney = [[0.2, 0], [0.17, 0.1], [0.15, 0.5], [0.26, 0.7], [0.28, 0.78], [0.2, 0.78], [0.12, 0.5], [0.12, 0.1]] as const;
  model.add(new LatheGeometry(chimney.map(([x, y]) => new Vector2(x, y)), 24), plain(BLACK), [1.75, 0, 2.08], [quarter, 0, 0]);
  model.add(new SphereGeometry(0.26, 24, 14), plain(BRASS), [0.45, 0, 2.18]);
  model.add(new CylinderGeometry(0.02, 0.13, 0.2, 20), plain(BRASS), [1.1, 0, 2.3], [quarter, 0, 0]);
  model.add(new CylinderGeometry(0.12, 0.12, 0.2, 20), plain(CREAM), [2.2, 0, 2.2], [0, 0, quarter]);
  // A plate with letters, on the left side.
  const letters: Paint = (at) => (Math.abs(at.z - 1.62) < 0.1 && hash(Math.round(at.x / 0.05), 1, Math.round(at.z / 0.06)) > 0.45 ? colour(CREAM) : colour(0x7b1f1f));
  model.add(box(1.1, 0.05, 0.34, [44, 1, 14]), letters, [0.45, 0.53, 1.62]);

  // Cab: posts, low walls and a roof around a hollow with a firebox; coal behind.
  for (const x of [-1.75, -0.75]) for (const y of [-0.55, 0.55]) model.add(box(0.1, 0.1, 1.5, [1, 1, 8]), plain(GREEN), [x, y, 1.82]);
  for (const y of [-0.57, 0.57]) model.add(box(1.1, 0.06, 0.7, [22, 1, 14]), banded(GREEN, BRASS, [-1.7, -0.8], 0.03), [-1.25, y, 1.42]);
  model.add(box(0.06, 1.1, 0.8, [1, 10, 8]), plain(GREEN), [-0.72, 0, 1.48]);
  model.add(new CylinderGeometry(0.28, 0.28, 0.1, 24), speckled(0xe07b2c, 0x7a2412, 0.07), [-0.8, 0, 1.5], [0, 0, quarter]);
  const roof: Paint = (at) => (Math.abs((at.x * 8) % 2) < 1 ? colour(RED) : colour(CREAM));
  model.add(box(1.5, 1.5, 0.09, [48, 6, 1]), roof, [-1.25, 0, 2.6]);
  for (let i = 0; i < 26; i += 1) {
    const [u, v, w] = [hash(i, 1, 2), hash(i, 3, 4), hash(i, 5, 6)];
    model.add(new IcosahedronGeometry(0.11 + 0.06 * w, 0), speckled(0x1f2023, 0x4a4c52, 0.09), [-2.02 + 0.3 * (u - 0.5), 0.8 * (v - 0.5), 1.2 + 0.24 * w]);
  }
  return model.done();
}
