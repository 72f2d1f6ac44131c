// The worker: loads the planner and its network, answers one request after the other.

import type { Reply, Request } from "../messages.js";
import { Engine, described } from "./engine.js";
import { load } from "./load.js";
import { openStore } from "./store.js";

declare const self: DedicatedWorkerGlobalScope;

const engine = (async () => {
  const [loaded, store] = await Promise.all([load(), openStore()]);
  return new Engine(loaded, store);
})();
// Told with the answer to the first request.
engine.catch(() => undefined);

let last: Promise<void> = Promise.resolve();

self.addEventListener("message", ({ data }: MessageEvent<Request>) => {
  // In order: a photo must be kept before the next one is planned.
  last = last.then(() => answer(data));
});

async function answer({ id, ...ask }: Request): Promise<void> {
  let reply: Reply;
  try {
    reply = { id, ...(await (await engine).answer(ask)) };
  } catch (error) {
    reply = { id, type: "refused", ...described(error) };
  }
  self.postMessage(reply);
}
