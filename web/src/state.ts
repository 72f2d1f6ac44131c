// The page's state and how events change it. No DOM in here.

import type { Progress, Reply } from "./messages.js";

/** From where the page looks at the dome, radians. */
export type Camera = { azimuthRad: number; elevationRad: number };

export type State = {
  run: number;
  /** Candidates' poses, shape (count, 3, 4); empty before the first plan. */
  poses: Float32Array;
  budget: number;
  progress: Progress | null;
  error: string | null;
  /** A request is on its way. */
  waiting: boolean;
  camera: Camera;
};

export type Event =
  | { type: "asked" }
  | { type: "asked-anew" }
  | { type: "replied"; reply: Reply }
  | { type: "invalid"; message: string }
  | { type: "turned"; azimuthRad: number; elevationRad: number };

export const initial: State = {
  run: 0,
  poses: new Float32Array(),
  budget: 0,
  progress: null,
  error: null,
  waiting: false,
  camera: { azimuthRad: -0.6, elevationRad: 0.45 },
};

/** The state after an event. */
export function next(state: State, event: Event): State {
  switch (event.type) {
    case "asked":
      return { ...state, waiting: true, error: null };
    case "asked-anew":
      return { ...state, run: state.run + 1, waiting: true, error: null };
    case "invalid":
      return { ...state, error: event.message };
    case "turned":
      return { ...state, camera: turned(state.camera, event.azimuthRad, event.elevationRad) };
    case "replied":
      // An answer to a plan that has been abandoned.
      return event.reply.run === state.run ? told(state, event.reply) : state;
  }
}

function told(state: State, reply: Reply): State {
  switch (reply.type) {
    case "started":
      return { ...state, poses: reply.poses, budget: reply.budget, progress: null };
    case "progress":
      return { ...state, progress: reply.progress, waiting: false };
    case "refused":
      return { ...state, error: reply.message, waiting: false };
  }
}

function turned(camera: Camera, azimuthRad: number, elevationRad: number): Camera {
  const limit = Math.PI / 2;
  return {
    azimuthRad: (camera.azimuthRad + azimuthRad) % (2 * Math.PI),
    elevationRad: Math.max(-limit, Math.min(limit, camera.elevationRad + elevationRad)),
  };
}

/** What there is to say about the next view, or why there is none. */
export function guidance(state: State): string {
  const { progress } = state;
  if (progress === null) return state.error === null ? "Preparing…" : "There is no plan yet.";
  const { next, finish } = progress;
  if (next !== null) {
    const { azimuthDeg, elevationDeg } = direction(next.pose);
    const way = elevationDeg < 0 ? "below" : "above";
    return (
      `View ${next.index}: ${Math.round(azimuthDeg)}° around, ` +
      `${Math.abs(Math.round(elevationDeg))}° ${way} the horizon. Why: ${next.why}.`
    );
  }
  switch (finish) {
    case "budget-spent":
      return "Done: all photos that were asked for have been taken.";
    case "nothing-left":
      return "Done: every other view is skipped or out of reach.";
    case "good-enough":
      return "Done: further views promise too little.";
    case null:
      return "There is no next view.";
  }
}

/** Where a pose stands as seen from the origin: degrees around from +X, and above the horizon. */
export function direction(pose: ArrayLike<number>): { azimuthDeg: number; elevationDeg: number } {
  const [x, y, z] = position(pose);
  const degrees = 180 / Math.PI;
  const azimuthDeg = (Math.atan2(y, x) * degrees + 360) % 360;
  return { azimuthDeg, elevationDeg: Math.atan2(z, Math.hypot(x, y)) * degrees };
}

/** The camera centre of pose `index` in rows of 12 numbers. */
export function position(poses: ArrayLike<number>, index = 0): [number, number, number] {
  const at = (row: number): number => poses[12 * index + 4 * row + 3] ?? Number.NaN;
  return [at(0), at(1), at(2)];
}
