// Where photos are kept as they are taken: the origin's private file system where it can be written
// from a worker, else IndexedDB, else memory, which the page says.

export interface Store {
  readonly kind: "opfs" | "indexeddb" | "memory";
  /** Writes whole or not at all. */
  put(name: string, bytes: Uint8Array): Promise<void>;
  get(name: string): Promise<Blob | null>;
  remove(name: string): Promise<void>;
  clear(): Promise<void>;
}

/** There is no room left; what was kept before is still there. */
export class StorageFull extends Error {
  readonly code = "storage-full";
  constructor() {
    super("The storage is full. Nothing is lost: save the capture now, or free some space and try again.");
  }
}

const FOLDER = "capture";

/** The best store that can really be written. */
export async function openStore(): Promise<Store> {
  for (const open of [Opfs.open, Idb.open]) {
    try {
      const store = await open();
      await store.put("probe", Uint8Array.of(1));
      await store.remove("probe");
      return store;
    } catch {
      // Private windows, old browsers, refused storage: the next one.
    }
  }
  return new Memory();
}

function fullOr(error: unknown): unknown {
  return error instanceof DOMException && error.name === "QuotaExceededError" ? new StorageFull() : error;
}

class Opfs implements Store {
  readonly kind = "opfs";
  private constructor(private folder: FileSystemDirectoryHandle) {}

  static async open(): Promise<Store> {
    const root = await navigator.storage.getDirectory();
    return new Opfs(await root.getDirectoryHandle(FOLDER, { create: true }));
  }

  async put(name: string, bytes: Uint8Array): Promise<void> {
    try {
      const file = await this.folder.getFileHandle(name, { create: true });
      const access = await file.createSyncAccessHandle();
      try {
        access.truncate(0);
        const written = access.write(bytes as Uint8Array<ArrayBuffer>, { at: 0 });
        if (written !== bytes.length) throw new StorageFull();
        access.flush();
      } finally {
        access.close();
      }
    } catch (error) {
      await this.remove(name).catch(() => undefined);
      throw fullOr(error);
    }
  }

  async get(name: string): Promise<Blob | null> {
    try {
      return await (await this.folder.getFileHandle(name)).getFile();
    } catch (error) {
      if (error instanceof DOMException && error.name === "NotFoundError") return null;
      throw error;
    }
  }

  async remove(name: string): Promise<void> {
    await this.folder.removeEntry(name).catch((error: unknown) => {
      if (!(error instanceof DOMException && error.name === "NotFoundError")) throw error;
    });
  }

  async clear(): Promise<void> {
    const names: string[] = [];
    for await (const name of this.folder.keys()) names.push(name);
    for (const name of names) await this.remove(name);
  }
}

class Idb implements Store {
  readonly kind = "indexeddb";
  private constructor(private database: IDBDatabase) {}

  static async open(): Promise<Store> {
    const request = indexedDB.open("vantage", 1);
    request.onupgradeneeded = () => request.result.createObjectStore(FOLDER);
    return new Idb(await settled(request));
  }

  async put(name: string, bytes: Uint8Array): Promise<void> {
    try {
      await this.change((store) => store.put(bytes, name));
    } catch (error) {
      throw fullOr(error);
    }
  }

  async get(name: string): Promise<Blob | null> {
    const store = this.database.transaction(FOLDER).objectStore(FOLDER);
    const found: unknown = await settled(store.get(name));
    return found instanceof Uint8Array ? new Blob([found as Uint8Array<ArrayBuffer>]) : null;
  }

  async remove(name: string): Promise<void> {
    await this.change((store) => store.delete(name));
  }

  async clear(): Promise<void> {
    await this.change((store) => store.clear());
  }

  /** Resolves when the change is on disk, not merely asked for. */
  private change(act: (store: IDBObjectStore) => IDBRequest): Promise<void> {
    return new Promise((resolve, reject) => {
      const transaction = this.database.transaction(FOLDER, "readwrite");
      transaction.oncomplete = () => resolve();
      transaction.onabort = () => reject(transaction.error);
      transaction.onerror = () => reject(transaction.error);
      act(transaction.objectStore(FOLDER));
    });
  }
}

function settled<T>(request: IDBRequest<T>): Promise<T> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

/** Nothing survives a reload. */
export class Memory implements Store {
  readonly kind = "memory";
  private files = new Map<string, Uint8Array>();

  async put(name: string, bytes: Uint8Array): Promise<void> {
    this.files.set(name, bytes.slice());
  }

  all(): [string, Uint8Array][] {
    return [...this.files];
  }

  async get(name: string): Promise<Blob | null> {
    const found = this.files.get(name);
    return found ? new Blob([found as Uint8Array<ArrayBuffer>]) : null;
  }

  async remove(name: string): Promise<void> {
    this.files.delete(name);
  }

  async clear(): Promise<void> {
    this.files.clear();
  }
}
