// Answers requests with a wasm session. No worker and no page in here, so that tests can call it.

import type { Progress, Reply, Request } from "./messages.js";
import { Pool, Session } from "vantage-wasm";

export class Planner {
  private session: Session | null = null;

  /** The answers to one request; never throws. */
  answer(request: Request): Reply[] {
    try {
      return this.carryOut(request);
    } catch (error) {
      return [{ type: "refused", run: request.run, ...described(error) }];
    }
  }

  private carryOut(request: Request): Reply[] {
    const { run } = request;
    switch (request.type) {
      case "start": {
        const pool = new Pool(request.space, request.count, request.radiusM);
        try {
          return this.begin(run, new Session(pool, request.plan));
        } finally {
          pool.free();
        }
      }
      case "restore":
        return this.begin(run, Session.restore(request.snapshot));
      case "take":
        return this.change(run, (session) => session.observe(request.index));
      case "skip":
        return this.change(run, (session) => session.skip(request.index));
      case "block":
        return this.change(run, (session) => session.block(request.index));
      case "unblock":
        return this.change(run, (session) => session.unblock(request.index));
      case "take-all":
        return this.change(run, (session) => {
          for (let next = session.nextView(); next; next = session.nextView()) {
            session.observe(next.index);
          }
        });
    }
  }

  /** The old session stays until the new one stands. */
  private begin(run: number, session: Session): Reply[] {
    this.session?.free();
    this.session = session;
    return [
      { type: "started", run, poses: session.poses(), budget: session.budget },
      { type: "progress", run, progress: progressOf(session) },
    ];
  }

  private change(run: number, act: (session: Session) => void): Reply[] {
    if (this.session === null) {
      return [{ type: "refused", run, code: "no-session", message: "start a plan first" }];
    }
    act(this.session);
    return [{ type: "progress", run, progress: progressOf(this.session) }];
  }
}

function progressOf(session: Session): Progress {
  const views = session.views();
  // A tour visits each view once, however often it was photographed.
  const tour = session.tour(Uint32Array.from(new Set(views)));
  return {
    statuses: session.statuses(),
    views: [...views],
    viewPoses: session.viewPoses(),
    next: session.nextView() ?? null,
    finish: session.finish() ?? null,
    tour: { order: [...tour.order], lengthRad: tour.lengthRad },
    snapshot: session.snapshot(),
  };
}

/** Code and message of whatever was thrown. */
export function described(error: unknown): { code: string; message: string } {
  if (error instanceof Error) {
    const code = "code" in error && typeof error.code === "string" ? error.code : "internal";
    return { code, message: error.message };
  }
  return { code: "internal", message: String(error) };
}

/** The buffers of a reply that can be handed over instead of copied. */
export function transferable(reply: Reply): ArrayBuffer[] {
  const arrays =
    reply.type === "started"
      ? [reply.poses]
      : reply.type === "progress"
        ? [reply.progress.viewPoses, reply.progress.snapshot]
        : [];
  return arrays.map((array) => array.buffer).filter((buffer) => buffer instanceof ArrayBuffer);
}
