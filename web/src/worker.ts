// The worker: owns the wasm module, answers one request after the other.

import type { Request } from "./messages.js";
import { Planner, described, transferable } from "./planner.js";
import { load } from "vantage-wasm";

declare const self: DedicatedWorkerGlobalScope;

const ready = load();
const planner = new Planner();

self.addEventListener("message", async (event: MessageEvent<Request>) => {
  const request = event.data;
  try {
    await ready;
  } catch (error) {
    self.postMessage({ type: "refused", run: request.run, ...described(error) });
    return;
  }
  for (const reply of planner.answer(request)) {
    self.postMessage(reply, { transfer: transferable(reply) });
  }
});
