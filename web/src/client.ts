// The page's end of the worker: asks and awaits answers.

import { Advice } from "./advice.js";
import type { Answer, Ask, Reply, Request } from "./messages.js";

/** A request was refused; the message is for people. */
export class Refusal extends Advice {
  constructor(readonly code: string, message: string) {
    super(message);
  }
}

type AnswerTo = {
  open: "opened"; start: "capture"; resume: "capture"; discard: "done"; shoot: "capture"; skip: "capture";
  block: "capture"; more: "capture"; delete: "capture"; mesh: "capture"; faces: "capture"; adopt: "capture";
  best: "best"; photo: "photo"; subject: "subject"; export: "exported"; import: "imported"; board: "board";
  track: "tracked";
};

export class Client {
  private worker = new Worker(new URL("./worker/worker.ts", import.meta.url), { type: "module" });
  private waiting = new Map<number, (reply: Answer) => void>();
  private count = 0;

  constructor() {
    this.worker.addEventListener("message", ({ data: { id, ...answer } }: MessageEvent<Reply>) => {
      this.waiting.get(id)?.(answer);
      this.waiting.delete(id);
    });
    this.worker.addEventListener("error", () => {
      const message = "The planner did not load. Reload the page; if that does not help, use a current browser.";
      for (const settle of this.waiting.values()) settle({ type: "refused", code: "no-worker", message });
      this.waiting.clear();
    });
  }

  /** The answer to a request; a refusal is thrown. Buffers in `transfer` are handed over. */
  ask<T extends Ask["type"]>(
    ask: Extract<Ask, { type: T }>, transfer: Transferable[] = [],
  ): Promise<Extract<Answer, { type: AnswerTo[T] }>> {
    this.count += 1;
    const request: Request = { id: this.count, ...(ask as Ask) };
    return new Promise((resolve, reject) => {
      this.waiting.set(request.id, (answer) => {
        if (answer.type === "refused") reject(new Refusal(answer.code, answer.message));
        else resolve(answer as Extract<Answer, { type: AnswerTo[T] }>);
      });
      this.worker.postMessage(request, transfer);
    });
  }
}
