// Zips: written without compression (photos are compressed already) and read by random access, so
// that neither needs the whole in memory. zip.js without its own workers: this is one.

import {
  BlobReader, BlobWriter, type FileEntry, Uint8ArrayReader, Uint8ArrayWriter, ZipReader, ZipWriter, configure,
} from "@zip.js/zip.js/lib/zip-core-native.js";

configure({ useWebWorkers: false });

export type Part = { path: string; content: Uint8Array | Blob };

/** Writes the parts in order, one at a time. */
export async function write(parts: AsyncIterable<Part>): Promise<Blob> {
  const zip = new ZipWriter(new BlobWriter("application/zip"), { level: 0, extendedTimestamp: false });
  for await (const { path, content } of parts) {
    await zip.add(path, content instanceof Blob ? new BlobReader(content) : new Uint8ArrayReader(content));
  }
  return zip.close();
}

/** The files of a zip: each is read when it is asked for, and its checksum compared. */
export async function open(zip: Blob): Promise<{ path: string; size: number; read: () => Promise<Uint8Array> }[]> {
  const entries = await new ZipReader(new BlobReader(zip)).getEntries();
  return entries
    .filter((entry): entry is FileEntry => !entry.directory)
    .map((entry) => ({
      path: entry.filename,
      size: entry.uncompressedSize,
      read: () => entry.getData(new Uint8ArrayWriter(), { checkSignature: true }),
    }));
}
