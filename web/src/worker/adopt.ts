// The files of an export of this page, back into the store: photos, and the windows that the
// network looks at.

import { resized } from "../geometry.js";
import type { CaptureRecord } from "../record.js";
import { cut } from "../window.js";
import * as pictures from "./pictures.js";
import type { Store } from "./store.js";

type Entry = { path: string; read: () => Promise<Uint8Array> };

export async function adoptFiles(store: Store, record: CaptureRecord, entries: readonly Entry[]): Promise<void> {
  for (const photo of record.photos) {
    const entry = entries.find(({ path }) => path === `images/${photo.file}`);
    if (!entry) throw new Error(`images/${photo.file} is missing: the capture cannot be gone on with.`);
    const bytes = await entry.read();
    const bitmap = await pictures.decode(new Blob([bytes as Uint8Array<ArrayBuffer>]));
    const pixels = pictures.pixelsOf(bitmap);
    bitmap.close();
    const window = cut(pixels, resized(record.lens, pixels.width, pixels.height), photo.pose, record.layout);
    await store.put(photo.file, bytes);
    await store.put(`${photo.file}.window`, window.rgb);
  }
}
