// Pictures in the worker: pixels of whatever arrives, files for the store, sizes before decoding.

import type { Pixels } from "../window.js";

/** Longer sides are made smaller before the network looks: the object still has pixels enough. */
const LONGEST_SIDE = 1024;
/** No more is decoded: a phone's largest photo has about 200 million pixels. */
const MOST_PIXELS = 120_000_000;

function context(width: number, height: number): OffscreenCanvasRenderingContext2D {
  const made = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  if (!made) throw new Error("this browser draws no pictures in a worker; a newer one does");
  return made;
}

/** The pixels of a picture, made smaller where it is large: RGBA. */
export function pixelsOf(source: ImageBitmap, longest = LONGEST_SIDE): Pixels {
  const shrink = Math.min(1, longest / Math.max(source.width, source.height));
  const [width, height] = [Math.max(1, Math.round(source.width * shrink)), Math.max(1, Math.round(source.height * shrink))];
  const drawing = context(width, height);
  drawing.imageSmoothingQuality = "high";
  drawing.drawImage(source, 0, 0, width, height);
  return drawing.getImageData(0, 0, width, height);
}

/** A picture as a file. */
export async function encode(picture: ImageBitmap, format: "png" | "jpg"): Promise<Uint8Array> {
  const drawing = context(picture.width, picture.height);
  drawing.drawImage(picture, 0, 0);
  const blob = await drawing.canvas.convertToBlob(
    format === "png" ? { type: "image/png" } : { type: "image/jpeg", quality: 0.94 },
  );
  return new Uint8Array(await blob.arrayBuffer());
}

/** Decodes a file as stored, without regard to EXIF orientation, as trainers take it. */
export async function decode(file: Blob): Promise<ImageBitmap> {
  const head = new Uint8Array(await file.slice(0, 1 << 18).arrayBuffer());
  const size = sizeOf(head);
  if (size === null) throw new Error("it is neither PNG nor JPEG");
  if (size.width * size.height > MOST_PIXELS) {
    throw new Error(`it has ${size.width} x ${size.height} pixels, more than this page decodes`);
  }
  try {
    return await createImageBitmap(file, { imageOrientation: "none" });
  } catch {
    throw new Error("it is damaged: it cannot be decoded");
  }
}

/** Width and height that a PNG's or JPEG's first bytes tell; null for anything else. */
export function sizeOf(bytes: Uint8Array): { width: number; height: number } | null {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length >= 24 && view.getUint32(0) === 0x89504e47 && view.getUint32(12) === 0x49484452) {
    return { width: view.getUint32(16), height: view.getUint32(20) };
  }
  if (bytes.length < 4 || view.getUint16(0) !== 0xffd8) return null;
  // JPEG: segments of marker and length, until a start of frame.
  for (let at = 2; at + 9 < bytes.length; ) {
    if (bytes[at] !== 0xff) return null;
    const marker = bytes[at + 1] ?? 0;
    const isFrame = marker >= 0xc0 && marker <= 0xcf && ![0xc4, 0xc8, 0xcc].includes(marker);
    if (isFrame) return { width: view.getUint16(at + 7), height: view.getUint16(at + 5) };
    at += 2 + view.getUint16(at + 2);
  }
  return null;
}

/** Brightness of RGBA pixels (Rec. 601), one byte a pixel. */
export function luma({ data, width, height }: Pixels): Uint8Array {
  const grey = new Uint8Array(width * height);
  for (let i = 0; i < grey.length; i += 1) {
    grey[i] = (77 * (data[4 * i] ?? 0) + 150 * (data[4 * i + 1] ?? 0) + 29 * (data[4 * i + 2] ?? 0)) >> 8;
  }
  return grey;
}
