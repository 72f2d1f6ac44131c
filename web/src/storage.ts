// The session in the browser's own storage, to go on after a reload.

const KEY = "vantage-session";

/** Keeps a snapshot; where storage is full or forbidden, the page goes on without. */
export function keep(snapshot: Uint8Array): void {
  try {
    localStorage.setItem(KEY, toText(snapshot));
  } catch {
    // Private windows may forbid storage.
  }
}

/** The snapshot that was kept, if any. */
export function kept(): Uint8Array | null {
  try {
    const text = localStorage.getItem(KEY);
    return text === null ? null : fromText(text);
  } catch {
    return null;
  }
}

/** Forgets the snapshot. */
export function forget(): void {
  try {
    localStorage.removeItem(KEY);
  } catch {
    // Nothing was kept.
  }
}

export function toText(bytes: Uint8Array): string {
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
}

export function fromText(text: string): Uint8Array {
  return Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
}
