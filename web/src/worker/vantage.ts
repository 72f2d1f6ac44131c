// What the worker calls `vantage-wasm` by, once it has loaded.

import type { load } from "vantage-wasm";

export type Vantage = Awaited<ReturnType<typeof load>>;
export type { BoardTracker, MeshLedger, Model, Photo, Session } from "vantage-wasm";
