// The picture of the object that the network looks at, from a photo taken anyhow (as
// lab/src/photos/window.rs makes it).
//
// The network was trained on the unit sphere seen from distance 3. A photo shows the object at
// another distance d, through another lens, off the middle, perhaps on its side. The window is what
// a camera at the same place would show that looks at the middle with its top towards the sky:
// turning a camera about its own centre only moves pixels about. Its half width is
// tan(FOV / 2) · 3 · radius / d, so that the object is as large as in training.

import { type Lens, type Pose, type Vec3, add, back, distance, dot, lookingAt, position, project, right, scale, up } from "./geometry.js";
import { DISTANCE, FOV_X_RAD, type Layout } from "./layout.js";

/** Side of the window, pixels. */
export const WINDOW = 64;
/** Behind photos that are transparent, and behind rendered objects in training. */
const BACKDROP = 128;

export type Pixels = { data: ArrayLike<number>; width: number; height: number };

/** The window, shape (64, 64, 3), and which share of it the photo covers. */
export type Cut = { rgb: Uint8Array; share: number };

/** Cuts the window out of a photo (RGBA, straight alpha) whose lens is given for its own size. */
export function cut(photo: Pixels, lens: Lens, pose: Pose, layout: Layout): Cut {
  const eye = position(pose);
  const half = (Math.tan(0.5 * FOV_X_RAD) * DISTANCE * layout.radius) / distance(eye, layout.centre);
  const aimed = lookingAt(eye, layout.centre, layout.up);
  const [x, y, z] = [right(aimed), up(aimed), back(aimed)];
  const [cx, cy, cz] = [right(pose), up(pose), back(pose)];
  // About one sample for each of the photo's pixels, along a pixel's side.
  const n = Math.max(2, Math.min(8, Math.ceil((2 * half * lens.fx) / WINDOW)));
  const rgb = new Uint8Array(WINDOW * WINDOW * 3);
  let inside = 0;
  for (let v = 0; v < WINDOW; v += 1) {
    for (let u = 0; u < WINDOW; u += 1) {
      const sum: [number, number, number] = [0, 0, 0];
      for (let sample = 0; sample < n * n; sample += 1) {
        const s = half * ((2 * (u + ((sample % n) + 0.5) / n)) / WINDOW - 1);
        const t = half * ((2 * (v + (Math.floor(sample / n) + 0.5) / n)) / WINDOW - 1);
        const ray: Vec3 = add(add(scale(x, s), scale(y, -t)), scale(z, -1));
        const place = project(lens, [dot(cx, ray), dot(cy, ray), dot(cz, ray)]);
        if (!place) continue;
        if (place[0] >= 0 && place[1] >= 0 && place[0] < lens.width && place[1] < lens.height) inside += 1;
        addLight(sum, photo, place[0], place[1]);
      }
      const at = 3 * (v * WINDOW + u);
      for (let c = 0; c < 3; c += 1) rgb[at + c] = encode((sum[c] ?? 0) / (n * n));
    }
  }
  return { rgb, share: inside / (WINDOW * WINDOW * n * n) };
}

/** Adds the light of the nearest pixel; beyond the edges the photo's border is repeated. */
function addLight(sum: [number, number, number], { data, width, height }: Pixels, x: number, y: number): void {
  const column = Math.max(0, Math.min(width - 1, Math.floor(x)));
  const line = Math.max(0, Math.min(height - 1, Math.floor(y)));
  const at = 4 * (line * width + column);
  const alpha = data[at + 3] ?? 255;
  for (let c = 0; c < 3; c += 1) {
    const level = ((data[at + c] ?? 0) * alpha + BACKDROP * (255 - alpha)) / 255;
    sum[c] = (sum[c] ?? 0) + (LINEAR[Math.round(level)] ?? 0);
  }
}

/** sRGB levels in linear light (IEC 61966-2-1). */
const LINEAR = Float32Array.from({ length: 256 }, (_, level) => {
  const v = level / 255;
  return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
});

function encode(light: number): number {
  const v = light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055;
  return Math.round(255 * Math.max(0, Math.min(1, v)));
}
