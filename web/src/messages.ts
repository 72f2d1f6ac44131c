// What page and worker say to each other: one union for each direction.
//
// The worker owns the wasm module and the session; the page owns the state it shows. `run` numbers
// the plans, so that an answer to an abandoned plan can be told apart.

import type { Finish, NextView, Plan, Status, ViewSpace } from "vantage-wasm";

export type { Finish, NextView, Plan, Status, ViewSpace };

export type Request =
  | { type: "start"; run: number; space: ViewSpace; count: number; radiusM: number; plan: Plan }
  | { type: "restore"; run: number; snapshot: Uint8Array }
  | { type: "take"; run: number; index: number }
  | { type: "skip"; run: number; index: number }
  | { type: "block"; run: number; index: number }
  | { type: "unblock"; run: number; index: number }
  | { type: "take-all"; run: number };

export type Reply =
  /** A plan has begun or come back: its candidates, shape (count, 3, 4). */
  | { type: "started"; run: number; poses: Float32Array; budget: number }
  /** After every change: all that moves. */
  | { type: "progress"; run: number; progress: Progress }
  /** A request was refused; nothing has changed. */
  | { type: "refused"; run: number; code: string; message: string };

export type Progress = {
  statuses: Status[];
  views: number[];
  /** Where the photos were taken, shape (views, 3, 4). */
  viewPoses: Float32Array;
  next: NextView | null;
  finish: Finish | null;
  /** The shortest way through the views taken, if one were to take them all again. */
  tour: { order: number[]; lengthRad: number };
  /** The session, to go on after a reload. */
  snapshot: Uint8Array;
};
