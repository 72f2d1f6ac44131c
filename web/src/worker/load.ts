// Loads the planner and its network.

import { Model, load as loadCore, loadedBuild } from "vantage-wasm";
import modelUrl from "vantage-wasm/soarnet.model?url";
import type { Loaded } from "./engine.js";

export async function load(): Promise<Loaded> {
  const [core, bytes] = await Promise.all([loadCore(), network()]);
  return { core, model: new Model(bytes), build: loadedBuild() ?? "scalar" };
}

async function network(): Promise<Uint8Array> {
  const response = await fetch(new URL(modelUrl, self.location.href));
  if (!response.ok) throw new Error("The network could not be loaded. Reload the page when you are online.");
  return new Uint8Array(await response.arrayBuffer());
}
