// Other programs' captures: transforms.json as nerfstudio, Polycam's and Record3D's nerfstudio
// exports, NeRFCapture and instant-ngp write it (the keys are those of lab/src/photos/transforms.rs),
// and Record3D's own metadata.json.

import { type Lens, type Pose, cross, dot, length, subtract } from "../geometry.js";

/** One listed photo: where its file may lie, its pose, its lens for a picture of a given size. */
export type Frame = { paths: string[]; name: string; pose: Float32Array; lens: (width: number, height: number) => Lens };
export type Foreign = { origin: string; frames: Frame[]; notes: string[]; keepsZUp: boolean };

/** What is wrong with a file, in one sentence. */
export class ForeignError extends Error {}

type Json = Record<string, unknown>;

const MODELS = ["OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "PERSPECTIVE", "SIMPLE_RADIAL", "RADIAL"];

export function parseTransforms(top: Json): Foreign {
  if (!Array.isArray(top["frames"])) throw new ForeignError("transforms.json has no list `frames`: it is not a capture.");
  if (top["frames"].length === 0) throw new ForeignError("transforms.json lists no photos.");
  const frames = top["frames"].map((value: unknown, index) => frame(top, value as Json, index + 1));
  const notes: string[] = [];
  const isDistorted = (value: Json): boolean =>
    ["k1", "k2", "k3", "k4", "p1", "p2"].some((key) => typeof value[key] === "number" && value[key] !== 0);
  if (isDistorted(top) || top["frames"].some((value: unknown) => isDistorted(value as Json))) {
    notes.push("Lens distortion is not corrected: it moves little within the 64 pixels looked at.");
  }
  if ("applied_transform" in top) notes.push("Poses are taken as they stand in the file, after its applied_transform.");
  const keepsZUp = top["orientation_override"] === "none";
  return { origin: originOf(top), frames, notes, keepsZUp };
}

/** Which program's habits a file shows. */
function originOf(top: Json): string {
  const first = (Array.isArray(top["frames"]) ? top["frames"][0] : {}) as Json;
  if (top["orientation_override"] === "none") return "Polycam, through nerfstudio";
  if (first["depth_path"] !== undefined || first["timestamp"] !== undefined) return "NeRFCapture";
  return top["camera_model"] === undefined ? "instant-ngp" : "nerfstudio";
}

function frame(top: Json, value: Json, number: number): Frame {
  const wrong = (what: string): ForeignError => new ForeignError(`Photo ${number} of transforms.json ${what}.`);
  if (typeof value !== "object" || value === null) throw wrong("is not described");
  const path = value["file_path"];
  if (typeof path !== "string" || path === "") throw wrong("has no `file_path`");
  const model = value["camera_model"] ?? top["camera_model"];
  if (typeof model === "string" && !MODELS.includes(model.toUpperCase())) {
    throw new ForeignError(`The lens ${model} is no pinhole: undistort the photos first.`);
  }
  const number_ = (key: string): number | null => {
    const found = value[key] ?? top[key];
    if (found === undefined || found === null) return null;
    if (typeof found !== "number" || !Number.isFinite(found)) throw wrong(`has a \`${key}\` that is no number`);
    return found;
  };
  const matrix = value["transform_matrix"];
  if (!Array.isArray(matrix)) throw wrong("has no `transform_matrix`");
  const pose = poseOf(matrix.slice(0, 3).flat(), wrong);
  const [w, h] = [number_("w"), number_("h")];
  const [flX, flY] = [number_("fl_x"), number_("fl_y")];
  const angle = number_("camera_angle_x");
  const [cx, cy] = [number_("cx"), number_("cy")];
  if (!(flX !== null ? flX > 0 : angle !== null && angle > 0 && angle < Math.PI)) throw wrong("has no `fl_x`");
  const lens = (width: number, height: number): Lens => {
    const [wide, tall] = [w ?? width, h ?? height];
    if (Math.min(Math.abs((width / wide) * tall - height), Math.abs((height / tall) * wide - width)) > 1.5) {
      throw new ForeignError(`it has ${width} x ${height} pixels where the file says ${wide} x ${tall}`);
    }
    const fx = flX ?? (0.5 * wide) / Math.tan(0.5 * (angle ?? 1));
    const [x, y] = [width / wide, height / tall];
    return { width, height, fx: fx * x, fy: (flY ?? fx) * y, cx: (cx ?? 0.5 * wide) * x, cy: (cy ?? 0.5 * tall) * y };
  };
  const plain = path.replaceAll("\\", "/").replace(/^\.\//, "");
  const hasExtension = /\.(png|jpe?g)$/i.test(plain);
  const endings = hasExtension ? [""] : ["", ".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG"];
  return { paths: endings.map((ending) => plain + ending), name: plain, pose, lens };
}

/** Columns may be off unit length or right angles by this much. */
const TOLERANCE = 1e-3;

function poseOf(numbers: unknown[], wrong: (what: string) => ForeignError): Float32Array {
  if (numbers.length !== 12 || !numbers.every((v): v is number => typeof v === "number" && Number.isFinite(v))) {
    throw wrong("has a `transform_matrix` that is not 4 rows of 4 numbers");
  }
  const column = (c: number): [number, number, number] => [numbers[c] ?? 0, numbers[c + 4] ?? 0, numbers[c + 8] ?? 0];
  const [x, y, z] = [column(0), column(1), column(2)];
  const isUnit = [x, y, z].every((axis) => Math.abs(length(axis) - 1) <= TOLERANCE);
  if (!isUnit || Math.max(Math.abs(dot(x, y)), Math.abs(dot(y, z))) > 3 * TOLERANCE) {
    throw wrong("has a `transform_matrix` that is not a rotation and a position");
  }
  if (length(subtract(cross(x, y), z)) > 0.1) throw wrong("has a mirrored `transform_matrix`");
  return Float32Array.from(numbers);
}

/** Record3D's own: K (column-major), poses as [qx, qy, qz, qw, x, y, z], photos `rgb/N.jpg`. */
export function parseRecord3d(top: Json): Foreign {
  const [k, poses, w, h] = [top["K"], top["poses"], top["w"], top["h"]];
  if (!Array.isArray(k) || !Array.isArray(poses) || typeof w !== "number" || typeof h !== "number") {
    throw new ForeignError("metadata.json has no `K`, `poses`, `w` and `h`: it is not Record3D's.");
  }
  const at = (index: number): number => (typeof k[index] === "number" ? k[index] : Number.NaN);
  const frames = poses.map((value: unknown, index): Frame => {
    const wrong = (what: string): ForeignError => new ForeignError(`Photo ${index} of metadata.json ${what}.`);
    const numbers = Array.isArray(value) ? value.map(Number) : [];
    if (numbers.length !== 7) throw wrong("has no pose of 7 numbers");
    const [qx, qy, qz, qw, x, y, z] = numbers as [number, number, number, number, number, number, number];
    const pose = poseOf([
      1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy), x,
      2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx), y,
      2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy), z,
    ], wrong);
    const lens = (width: number, height: number): Lens => {
      const [sx, sy] = [width / w, height / h];
      return { width, height, fx: at(0) * sx, fy: at(4) * sy, cx: at(6) * sx, cy: at(7) * sy };
    };
    return { paths: [`rgb/${index}.jpg`, `rgb/${index}.png`], name: `rgb/${index}.jpg`, pose, lens };
  });
  if (frames.length === 0) throw new ForeignError("metadata.json lists no poses.");
  return { origin: "Record3D", frames, notes: [], keepsZUp: false };
}

/** Polycam's raw export: one JSON for each photo, `keyframes/cameras/*.json`. */
export function parsePolycam(cameras: { path: string; content: Json }[]): Foreign {
  const frames = cameras.map(({ path, content }): Frame => {
    const wrong = (what: string): ForeignError => new ForeignError(`${path} ${what}.`);
    const number = (key: string): number => {
      const found = content[key];
      if (typeof found !== "number" || !Number.isFinite(found)) throw wrong(`has no \`${key}\``);
      return found;
    };
    const t = (row: number): number[] => [0, 1, 2, 3].map((column) => number(`t_${row}${column}`));
    // ARKit's world is +Y up: nerfstudio's converter keeps the same matrix with its rows turned.
    const pose = poseOf([...t(2), ...t(0), ...t(1)], wrong);
    const [w, h, fx, fy, cx, cy] = [number("width"), number("height"), number("fx"), number("fy"), number("cx"), number("cy")];
    const lens = (width: number, height: number): Lens => {
      const [sx, sy] = [width / w, height / h];
      return { width, height, fx: fx * sx, fy: fy * sy, cx: cx * sx, cy: cy * sy };
    };
    const stem = path.slice(path.lastIndexOf("/") + 1).replace(/\.json$/, "");
    const folder = path.includes("corrected_cameras") ? "corrected_images" : "images";
    const name = `keyframes/${folder}/${stem}.jpg`;
    return { paths: [name, `keyframes/images/${stem}.jpg`], name, pose, lens };
  });
  return { origin: "Polycam", frames, notes: [], keepsZUp: true };
}

export type { Pose };
