// The page's state and how events change it. No DOM in here.

import type { Guide } from "./camera/hints.js";
import type { Aim } from "./camera/xr/placing.js";
import type { CaptureView, Engine, ImportReport, Kept, Parcel, Tracked } from "./messages.js";
import type { PoseSource } from "./record.js";

export type Screen = "home" | "simulate" | "setup" | "camera" | "review" | "import";

/** From where the page looks at the dome, radians. */
export type DomeSide = { azimuthRad: number; elevationRad: number };

export type Notice = { level: "error" | "info"; text: string };

/** What the camera screen knows right now. */
export type Live = {
  source: PoseSource;
  size: { width: number; height: number } | null;
  tracked: Tracked | null;
  guide: Guide | null;
  /** How far the auto-shutter has waited, in [0, 1]. */
  steady: number;
  /** Photos taken since the camera started: each one flashes. */
  flashes: number;
  isAutomatic: boolean;
  isSpoken: boolean;
  /** Without a board: the object of this size is being placed, and was aimed at once already. */
  placing: { objectM: number; aim: Aim | null } | null;
};

export type State = {
  screen: Screen;
  /** Null until the worker has loaded. */
  engine: Engine | null;
  /** Why the page cannot plan at all. */
  failure: string | null;
  kept: Kept | null;
  view: CaptureView | null;
  /** What is being done; null when the page waits for the person. */
  busy: string | null;
  isRunning: boolean;
  notice: Notice | null;
  dome: DomeSide;
  /** Small pictures by the photo's number. */
  thumbnails: ReadonlyMap<number, string>;
  selected: number | null;
  best: { order: number[]; count: number } | null;
  parcel: (Omit<Parcel, "blob"> & { url: string; size: number }) | null;
  report: ImportReport | null;
  board: BoardChoice;
  live: Live;
  /** Whether the browser offers AR with its own tracking. */
  hasAr: boolean;
  isOffline: boolean;
};

/** What is printed, and how large the object on it is. */
export type BoardChoice = { page: "a4" | "letter"; objectM: number; svgUrl: string | null };

export type Event =
  | { type: "opened"; engine: Engine; kept: Kept | null }
  | { type: "failed"; message: string }
  | { type: "went"; screen: Screen }
  | { type: "began"; what: string }
  | { type: "ended" }
  | { type: "running"; isRunning: boolean }
  | { type: "captured"; view: CaptureView }
  | { type: "discarded" }
  | { type: "noticed"; notice: Notice | null }
  | { type: "turned"; azimuthRad: number; elevationRad: number }
  | { type: "pictured"; number: number; url: string }
  | { type: "selected"; number: number | null }
  | { type: "ranked"; order: number[] }
  | { type: "counted"; count: number }
  | { type: "packed"; parcel: NonNullable<State["parcel"]> }
  | { type: "reported"; report: ImportReport }
  | { type: "boarded"; board: Partial<BoardChoice> }
  | { type: "lived"; live: Partial<Live> }
  | { type: "sensed"; hasAr: boolean }
  | { type: "connected"; isOffline: boolean };

export const initial: State = {
  screen: "home",
  engine: null,
  failure: null,
  kept: null,
  view: null,
  busy: null,
  isRunning: false,
  notice: null,
  dome: { azimuthRad: -0.7, elevationRad: 0.5 },
  thumbnails: new Map(),
  selected: null,
  best: null,
  parcel: null,
  report: null,
  board: { page: "a4", objectM: 0.1, svgUrl: null },
  live: { source: "board", size: null, tracked: null, guide: null, steady: 0, flashes: 0, isAutomatic: true, isSpoken: false, placing: null },
  hasAr: false,
  isOffline: false,
};

/** The state after an event. */
export function next(state: State, event: Event): State {
  switch (event.type) {
    case "opened":
      return { ...state, engine: event.engine, kept: event.kept };
    case "failed":
      return { ...state, failure: event.message, busy: null };
    case "went":
      return { ...state, screen: event.screen, notice: null, selected: null };
    case "began":
      return { ...state, busy: event.what, notice: null };
    case "ended":
      return { ...state, busy: null };
    case "running":
      return { ...state, isRunning: event.isRunning };
    case "captured":
      return captured(state, event.view);
    case "discarded":
      return { ...state, view: null, kept: null, thumbnails: new Map(), best: null, parcel: null, isRunning: false };
    case "noticed":
      return { ...state, notice: event.notice };
    case "turned":
      return { ...state, dome: turned(state.dome, event.azimuthRad, event.elevationRad) };
    case "pictured":
      return { ...state, thumbnails: new Map(state.thumbnails).set(event.number, event.url) };
    case "selected":
      return { ...state, selected: event.number };
    case "ranked":
      return { ...state, best: { order: event.order, count: Math.min(state.best?.count ?? 12, event.order.length) } };
    case "counted":
      return state.best === null ? state : { ...state, best: { ...state.best, count: event.count } };
    case "packed":
      return { ...state, parcel: event.parcel };
    case "reported":
      return { ...state, report: event.report, screen: "import" };
    case "boarded":
      return { ...state, board: { ...state.board, ...event.board } };
    case "lived":
      return { ...state, live: { ...state.live, ...event.live } };
    case "sensed":
      return { ...state, hasAr: event.hasAr };
    case "connected":
      return { ...state, isOffline: event.isOffline };
  }
}

/** Photos have come or gone: what was derived from the old ones no longer holds. */
function captured(state: State, view: CaptureView): State {
  const before = state.view?.record.photos.map((photo) => photo.number).join() ?? "";
  const after = view.record.photos.map((photo) => photo.number);
  if (before === after.join()) return { ...state, view, kept: null };
  const thumbnails = new Map([...state.thumbnails].filter(([number]) => after.includes(number)));
  const selected = state.selected !== null && after.includes(state.selected) ? state.selected : null;
  return { ...state, view, kept: null, thumbnails, selected, best: null, parcel: null };
}

function turned(side: DomeSide, azimuthRad: number, elevationRad: number): DomeSide {
  const limit = Math.PI / 2;
  return {
    azimuthRad: (side.azimuthRad + azimuthRad) % (2 * Math.PI),
    elevationRad: Math.max(-limit, Math.min(limit, side.elevationRad + elevationRad)),
  };
}

/** Whether a next photo can be taken now. */
export const canTake = (state: State): boolean => state.busy === null && state.view?.next != null;
