// Files and folders that were dropped or chosen, with their paths.

import { Advice } from "./advice.js";
import type { Named } from "./messages.js";

/** More files than any capture has: somebody's whole disk. */
const MOST_FILES = 20_000;

export async function dropped(data: DataTransfer | null): Promise<Named[]> {
  const entries = [...(data?.items ?? [])].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  const found: Named[] = [];
  for (const entry of entries) await walk(entry, found);
  return found;
}

/** The files of an input, folders included. */
export function chosen(input: HTMLInputElement): Named[] {
  return [...(input.files ?? [])].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
}

async function walk(entry: FileSystemEntry, found: Named[]): Promise<void> {
  if (found.length >= MOST_FILES) throw new Advice("That folder has too many files: choose the capture's own folder.");
  if (isFile(entry)) {
    const file = await new Promise<File>((resolve, reject) => entry.file(resolve, reject));
    found.push({ path: entry.fullPath.replace(/^\//, ""), file });
  } else if (isFolder(entry)) {
    const reader = entry.createReader();
    for (;;) {
      const part = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
      if (part.length === 0) return;
      for (const child of part) await walk(child, found);
    }
  }
}

const isFile = (entry: FileSystemEntry): entry is FileSystemFileEntry => entry.isFile;
const isFolder = (entry: FileSystemEntry): entry is FileSystemDirectoryEntry => entry.isDirectory;
