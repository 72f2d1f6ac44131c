// One zip that trainers open, checked before it is offered.

import { distance, position, turnBetween } from "../geometry.js";
import type { Parcel } from "../messages.js";
import type { CaptureRecord } from "../record.js";
import type { Capture } from "./capture.js";
import { NB_INFO, colmap, matrix4, readme, transforms } from "./files.js";
import { sizeOf } from "./pictures.js";
import { type Point, padded, ply, unpack } from "./points.js";
import * as zip from "./zip.js";

/** Writes the capture's folder as a zip and reads it back. */
export async function exportCapture(capture: Capture): Promise<Parcel> {
  const { record } = capture;
  if (record.photos.length === 0) throw new Error("There are no photos to save yet: take at least one.");
  const folder = folderName(record.name);
  const blob = await zip.write(parts(capture, folder));
  const checks = await check(blob, record);
  return { blob, name: `${folder}.zip`, photos: record.photos.length, checks };
}

/** A name that every file system and shell takes as it is. */
export function folderName(name: string): string {
  const plain = name.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "");
  return plain === "" ? "capture" : plain.slice(0, 60);
}

/** Photos are numbered anew, without the gaps that deleted ones left. */
export function fileNames(record: CaptureRecord): string[] {
  return record.photos.map((photo, index) => {
    const extension = photo.file.slice(photo.file.lastIndexOf("."));
    return `frame_${String(index + 1).padStart(5, "0")}${extension}`;
  });
}

async function* parts(capture: Capture, folder: string): AsyncIterable<zip.Part> {
  const { record, store } = capture;
  const names = fileNames(record);
  const text = (content: string): Uint8Array => new TextEncoder().encode(content);
  const json = (value: object): Uint8Array => text(`${JSON.stringify(value, null, 2)}\n`);
  const at = (path: string): string => `${folder}/${path}`;

  const points: Point[] = [];
  for (const photo of record.photos) {
    const blob = await store.get(`${photo.file}.points`);
    if (blob) points.push(...unpack(await blob.arrayBuffer()));
  }
  const cloud = padded(points, record.layout.centre, record.layout.radius)
    .map((point): Point => ({ ...point, position: float32(point.position) }));

  for (const [index, photo] of record.photos.entries()) {
    yield { path: at(`images/${names[index] ?? photo.file}`), content: await capture.photoFile(photo.number) };
  }
  yield { path: at("transforms.json"), content: json(transforms(record, names, cloud)) };
  yield { path: at("sparse_pc.ply"), content: ply(cloud) };
  for (const [name, content] of colmap(record, names, cloud)) yield { path: at(`sparse/0/${name}`), content };
  yield { path: at("nb-info.json"), content: text(NB_INFO) };
  const renamed = record.photos.map((photo, index) => ({ ...photo, file: names[index] ?? photo.file }));
  yield { path: at("capture.json"), content: json({ ...record, photos: renamed }) };
  yield { path: at("README.md"), content: text(readme(record)) };
}

/** As the PLY holds it, so that all files say the same. */
function float32(v: Point["position"]): Point["position"] {
  return [Math.fround(v[0]), Math.fround(v[1]), Math.fround(v[2])];
}

/** Reads the zip as a stranger would; whatever is wrong is an error, and the zip is not offered. */
async function check(blob: Blob, record: CaptureRecord): Promise<string[]> {
  const files = new Map((await zip.open(blob)).map((file) => [file.path.slice(file.path.indexOf("/") + 1), file]));
  const read = async (path: string): Promise<Uint8Array> => {
    const file = files.get(path);
    if (!file) throw new Error(`The zip failed its own check: ${path} is missing. Try again.`);
    return file.read();
  };
  const parsed = JSON.parse(new TextDecoder().decode(await read("transforms.json"))) as {
    frames: { file_path: string; transform_matrix: number[][] }[];
  };
  const wrong = (what: string): Error => new Error(`The zip failed its own check: ${what}. Try again.`);
  if (parsed.frames.length !== record.photos.length) throw wrong("a photo is missing");
  let worstTurn = 0;
  for (const [index, frame] of parsed.frames.entries()) {
    const photo = record.photos[index];
    if (!photo) throw wrong("there is a photo too many");
    const picture = await read(frame.file_path); // its checksum is compared here
    if (picture.length !== photo.bytes) throw wrong(`${frame.file_path} is cut short`);
    const size = sizeOf(picture);
    if (!size || size.width !== record.lens.width || size.height !== record.lens.height) {
      throw wrong(`${frame.file_path} is not as large as the camera's pictures`);
    }
    const pose = frame.transform_matrix.slice(0, 3).flat();
    const apart = distance(position(pose), position(photo.pose));
    if (apart > 1e-6 * (1 + record.layout.distance)) throw wrong(`the pose of ${frame.file_path} has moved`);
    worstTurn = Math.max(worstTurn, turnBetween(pose, matrix4(photo.pose).slice(0, 3).flat()));
  }
  if (worstTurn > 1e-6) throw wrong("a pose has turned");
  for (const path of ["sparse_pc.ply", "sparse/0/images.bin", "sparse/0/images.txt", "README.md", "capture.json"]) {
    await read(path);
  }
  return [
    `${record.photos.length} photos: present, whole, ${record.lens.width} × ${record.lens.height} pixels`,
    "their poses agree with what was captured",
    "transforms.json, sparse/0 and the point cloud read back",
  ];
}
