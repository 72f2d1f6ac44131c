// The files of an export around the photos, with the layout of `vantage plan --out`
// (lab/src/export): transforms.json, sparse_pc.ply, sparse/0 as text and binary, nb-info.json,
// capture.json and README.md. Poses are written in double precision from the same normalised
// quaternion, so the files agree with each other.

import { type Lens, type Pose, type Vec3, position } from "../geometry.js";
import type { CaptureRecord } from "../record.js";
import { TRUST } from "../record.js";
import type { Point } from "./points.js";

type Quaternion = readonly [w: number, x: number, y: number, z: number];

/** The rotation of a pose as a unit quaternion (Shepperd, 1978). */
export function quaternion(p: Pose): Quaternion {
  const m = (row: number, column: number): number => p[4 * row + column] ?? Number.NaN;
  const trace = m(0, 0) + m(1, 1) + m(2, 2);
  const candidates = [trace, m(0, 0), m(1, 1), m(2, 2)];
  const largest = candidates.indexOf(Math.max(...candidates));
  const q: [number, number, number, number] =
    largest === 0
      ? [1 + trace, m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)]
      : largest === 1
        ? [m(2, 1) - m(1, 2), 1 + m(0, 0) - m(1, 1) - m(2, 2), m(0, 1) + m(1, 0), m(0, 2) + m(2, 0)]
        : largest === 2
          ? [m(0, 2) - m(2, 0), m(0, 1) + m(1, 0), 1 - m(0, 0) + m(1, 1) - m(2, 2), m(1, 2) + m(2, 1)]
          : [m(1, 0) - m(0, 1), m(0, 2) + m(2, 0), m(1, 2) + m(2, 1), 1 - m(0, 0) - m(1, 1) + m(2, 2)];
  const norm = Math.hypot(...q);
  return [q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm];
}

/** The rotation matrix of a unit quaternion, rows. */
function matrix([w, x, y, z]: Quaternion): [Vec3, Vec3, Vec3] {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
}

/** `world_from_camera` in double precision, shape (4, 4). */
export function matrix4(pose: Pose): number[][] {
  const [a, b, c] = matrix(quaternion(pose));
  const [x, y, z] = position(pose);
  return [[...a, x], [...b, y], [...c, z], [0, 0, 0, 1]];
}

/** nerfstudio's and instant-ngp's file. */
export function transforms(record: CaptureRecord, names: readonly string[], points: readonly Point[]): object {
  const { lens, photos } = record;
  return {
    camera_model: "OPENCV",
    camera_angle_x: 2 * Math.atan((0.5 * lens.width) / lens.fx),
    fl_x: lens.fx, fl_y: lens.fy, cx: lens.cx, cy: lens.cy, w: lens.width, h: lens.height,
    k1: 0, k2: 0, p1: 0, p2: 0,
    aabb_scale: aabbScale(points),
    ply_file_path: "sparse_pc.ply",
    frames: photos.map((photo, index) => ({
      file_path: `images/${names[index] ?? photo.file}`,
      transform_matrix: matrix4(photo.pose),
    })),
  };
}

/** The least power of two, up to 128, whose cube holds the points in instant-ngp. */
function aabbScale(points: readonly Point[]): number {
  const reach = points.reduce((most, point) => Math.max(most, ...point.position.map(Math.abs)), 0);
  let scale = 1;
  while (scale < 128 && reach > (scale * 0.5) / 0.33) scale *= 2;
  return scale;
}

type ColmapPose = { rotation: Quaternion; translation: Vec3 };

/** camera_from_world with OpenCV axes: (world_from_camera · turn_x(pi))⁻¹, w >= 0. */
export function colmapPose(pose: Pose): ColmapPose {
  const [w, x, y, z] = quaternion(pose);
  // q · (0, 1, 0, 0), then the conjugate.
  let rotation: Quaternion = [-x, -w, -z, y];
  if (rotation[0] < 0) rotation = [-rotation[0], -rotation[1], -rotation[2], -rotation[3]];
  const [a, b, c] = matrix(rotation);
  const p = position(pose);
  const along = (v: Vec3): number => -(v[0] * p[0] + v[1] * p[1] + v[2] * p[2]);
  return { rotation, translation: [along(a), along(b), along(c)] };
}

/** `sparse/0`: names and contents, text and binary. */
export function colmap(record: CaptureRecord, names: readonly string[], points: readonly Point[]): [string, Uint8Array][] {
  const { lens } = record;
  const poses = record.photos.map((photo) => colmapPose(photo.pose));
  const text = (content: string): Uint8Array => new TextEncoder().encode(content);
  const images = poses.map(({ rotation, translation }, index) =>
    `${index + 1} ${[...rotation, ...translation].join(" ")} 1 ${names[index] ?? ""}\n\n`);
  const listed = points.map(({ position: p, colour }, index) => `${index + 1} ${p.join(" ")} ${colour.join(" ")} 0\n`);
  return [
    ["cameras.txt", text(
      `# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 PINHOLE ${lens.width} ${lens.height} ${lens.fx} ${lens.fy} ${lens.cx} ${lens.cy}\n`)],
    ["images.txt", text(
      `# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n${images.join("")}`)],
    ["points3D.txt", text(`# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[]\n${listed.join("")}`)],
    ["cameras.bin", camerasBinary(lens)],
    ["images.bin", imagesBinary(poses, names)],
    ["points3D.bin", pointsBinary(points)],
  ];
}

/** Little-endian numbers one after the other. */
class Bytes {
  private parts: number[] = [];
  private cell = new DataView(new ArrayBuffer(8));

  u64(value: number): this {
    this.cell.setBigUint64(0, BigInt(value), true);
    return this.take(8);
  }
  u32(value: number): this {
    this.cell.setUint32(0, value, true);
    return this.take(4);
  }
  doubles(values: Iterable<number>): this {
    for (const value of values) {
      this.cell.setFloat64(0, value, true);
      this.take(8);
    }
    return this;
  }
  raw(values: Iterable<number>): this {
    for (const value of values) this.parts.push(value);
    return this;
  }
  done(): Uint8Array {
    return Uint8Array.from(this.parts);
  }
  private take(count: number): this {
    for (let i = 0; i < count; i += 1) this.parts.push(this.cell.getUint8(i));
    return this;
  }
}

function camerasBinary(lens: Lens): Uint8Array {
  // 1 is COLMAP's number for its model PINHOLE.
  const bytes = new Bytes().u64(1).u32(1).u32(1).u64(lens.width).u64(lens.height);
  return bytes.doubles([lens.fx, lens.fy, lens.cx, lens.cy]).done();
}

function imagesBinary(poses: readonly ColmapPose[], names: readonly string[]): Uint8Array {
  const bytes = new Bytes().u64(poses.length);
  poses.forEach(({ rotation, translation }, index) => {
    bytes.u32(index + 1).doubles(rotation).doubles(translation).u32(1);
    bytes.raw(new TextEncoder().encode(names[index] ?? "")).raw([0]).u64(0);
  });
  return bytes.done();
}

function pointsBinary(points: readonly Point[]): Uint8Array {
  const bytes = new Bytes().u64(points.length);
  points.forEach(({ position: p, colour }, index) => {
    bytes.u64(index + 1).doubles(p).raw(colour).doubles([0]).u64(0);
  });
  return bytes.done();
}

/** Without it nerfbaselines finds two formats in one folder and stops. */
export const NB_INFO = '{"loader": "colmap", "type": "object-centric"}\n';

/** How to open the folder, for people. */
export function readme(record: CaptureRecord): string {
  const sources = [...new Set(record.photos.map((photo) => photo.source))];
  const trust = sources.map((source) => `- ${TRUST[source].title}: ${TRUST[source].trust}.`).join("\n");
  const isGuess = sources.includes("orientation");
  return `# ${record.name}

${record.photos.length} photos with poses, planned and taken with Vantage. Unzip, open a terminal in
this folder, and train:

| trainer | command |
|---|---|
| nerfstudio | \`ns-train splatfacto --data .\` |
| brush | \`brush_app .\` |
| gsplat | \`python simple_trainer.py default --data_dir . --data_factor 1\` (in gsplat's examples folder, with this folder's full path) |
| 3D Gaussian Splatting (Inria) | \`python train.py -s .\` (with this folder's full path) |
| instant-ngp | \`./instant-ngp --scene .\` (with this folder's full path) |
| COLMAP | \`colmap gui --import_path sparse/0 --image_path images\` |

nerfstudio keeps a tenth of the photos for evaluation; add \`nerfstudio-data --eval-mode all\` to train on
all. gsplat and Inria's trainer keep every eighth where they are asked to evaluate.

## Poses

${trust}
${isGuess ? `
**These poses are guesses.** Let the trainer find them from the photos instead:
\`ns-process-data images --data images --output-dir processed\`, then \`ns-train splatfacto --data processed\`.
` : ""}
\`transforms.json\`: world_from_camera, OpenGL camera axes, +Z up. \`sparse/0\`: the same for COLMAP's
readers. \`capture.json\`: for each photo its pose source, quality, scores and the reason it was asked for.
`;
}
