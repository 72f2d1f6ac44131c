// The capture's record and the planner's snapshot in the store, written in turn to one of two files:
// a crash in the middle of a write leaves the other one whole.

import { type CaptureRecord, checkRecord } from "../record.js";
import type { Store } from "./store.js";

export type Entry = { record: CaptureRecord; snapshot: Uint8Array };

const NAMES = ["journal-a", "journal-b"] as const;

export class Journal {
  private sequence = 0;

  constructor(private store: Store) {}

  async write({ record, snapshot }: Entry): Promise<void> {
    const sequence = this.sequence + 1;
    const content = JSON.stringify({ sequence, record, snapshot: toText(snapshot) });
    const line = `${checksum(content)}\n${content}`;
    await this.store.put(nameOf(sequence), new TextEncoder().encode(line));
    this.sequence = sequence;
  }

  /** The latest entry that is whole; null where there is none. */
  async read(): Promise<Entry | null> {
    let latest: Entry | null = null;
    for (const name of NAMES) {
      const blob = await this.store.get(name);
      const found = blob === null ? null : parse(await blob.text());
      if (found !== null && found.sequence > this.sequence) {
        this.sequence = found.sequence;
        latest = found;
      }
    }
    return latest;
  }
}

const nameOf = (sequence: number): string => (sequence % 2 === 0 ? NAMES[0] : NAMES[1]);

function parse(line: string): (Entry & { sequence: number }) | null {
  const cut = line.indexOf("\n");
  const content = line.slice(cut + 1);
  if (cut < 0 || line.slice(0, cut) !== checksum(content)) return null;
  try {
    const value = JSON.parse(content) as { sequence: number; record: unknown; snapshot: string };
    return { sequence: value.sequence, record: checkRecord(value.record), snapshot: fromText(value.snapshot) };
  } catch {
    return null;
  }
}

/** FNV-1a over UTF-16 units: tells a torn write from a whole one. */
function checksum(text: string): string {
  let hash = 0x811c9dc5;
  for (let i = 0; i < text.length; i += 1) {
    hash = Math.imul(hash ^ text.charCodeAt(i), 0x01000193);
  }
  return (hash >>> 0).toString(16).padStart(8, "0");
}

const toText = (bytes: Uint8Array): string => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
const fromText = (text: string): Uint8Array => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
