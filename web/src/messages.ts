// What page and worker say to each other. The worker owns the wasm module, the storage and the
// photos; the page owns the state it shows. Every request has a number, which its answer repeats.

import type { Finish, NextView, Objective, Plan, Scores, Status, ViewSpace } from "./core.js";
import type { BoardSpec } from "vantage-wasm";
import type { Lens } from "./geometry.js";
import type { Layout } from "./layout.js";
import type { CaptureRecord, PoseSource, Quality, Subject } from "./record.js";

export type Ask =
  /** Loads the planner and looks for a capture that was kept. */
  | { type: "open" }
  /** Begins a capture; whatever was kept before is removed. */
  | { type: "start"; setup: Setup }
  /** Goes on with the capture that was kept. */
  | { type: "resume" }
  | { type: "discard" }
  | { type: "shoot"; shot: Shot }
  | { type: "skip"; candidate: number }
  | { type: "block"; candidate: number }
  /** Goes on past the budget or the good-enough point. */
  | { type: "more"; views: number }
  | { type: "delete"; number: number }
  /** The object's triangles, for the exact curves of a simulated capture: shape (faces, 3, 3). */
  | { type: "mesh"; triangles: Float32Array }
  /** The faces of a photo taken before a reload. */
  | { type: "faces"; number: number; faces: Faces }
  /** Orders the photos so that the first n are the best n. */
  | { type: "best" }
  | { type: "photo"; number: number }
  | { type: "subject" }
  | { type: "export" }
  | { type: "import"; files: Named[] }
  /** Goes on with the capture that was imported. */
  | { type: "adopt" }
  | { type: "board"; spec: BoardSpec; page: "a4" | "letter" }
  /** Looks at a camera frame: how good it is and, given a board, where it was taken from. */
  | { type: "track"; spec: BoardSpec | null; frame: ImageBitmap };

export type Request = Ask & { id: number };

export type Answer =
  | { type: "opened"; engine: Engine; kept: Kept | null }
  | { type: "capture"; view: CaptureView }
  | { type: "done" }
  | { type: "best"; order: number[] }
  | { type: "photo"; blob: Blob }
  | { type: "subject"; blob: Blob | null }
  | { type: "exported"; parcel: Parcel }
  | { type: "imported"; report: ImportReport }
  | { type: "board"; svg: string }
  | { type: "tracked"; tracked: Tracked }
  /** Refused; nothing has changed. `message` is for people. */
  | { type: "refused"; code: string; message: string };

export type Reply = Answer & { id: number };

export type Engine = { build: "simd" | "scalar"; storage: "opfs" | "indexeddb" | "memory" };

/** A capture that was kept from last time. */
export type Kept = { name: string; photos: number; startedAt: string; subject: Subject };

export type Setup = {
  name: string;
  subject: Subject;
  layout: Layout;
  lens: Lens;
  pool: { space: ViewSpace; count: number };
  plan: Plan;
  /** The dropped file itself, to show the object again after a reload. */
  file?: Blob;
};

/** Other ways to choose the same number of photos. */
export const RIVALS = ["rings", "farthest", "random"] as const;
export type Rival = (typeof RIVALS)[number];

/** Face ids of rendered views (number + 1, 0 = nothing), one a pixel. */
export type Faces = { planner: Uint32Array } & Partial<Record<Rival, Uint32Array>>;

export type Shot = {
  /** Null: the camera frame that was looked at last, to which the pose belongs. */
  picture: ImageBitmap | null;
  /** Renders keep their alpha; the camera's pictures need none. */
  format: "png" | "jpg";
  /** `world_from_camera` really reached, the capture's coordinates. */
  pose: Float32Array;
  candidate: number | null;
  source: PoseSource;
  /** Where the lens is known better than from the capture's start. */
  lens?: Lens;
  rmsPx?: number;
  faces?: Faces;
};

export type CaptureView = {
  record: CaptureRecord;
  /** Poses of the candidates in the planner's coordinates, shape (count, 3, 4). */
  candidates: Float32Array;
  statuses: Status[];
  next: NextView | null;
  finish: Finish | null;
  progress: Progress | null;
  curves: Curves | null;
  /** Where the rivals stand, photo by photo, the planner's coordinates. */
  rivalPoses: Record<Rival, Float32Array> | null;
  /** About how many further photos fit into the storage; null where it does not say. */
  room: number | null;
};

/** Expected, not known: what the network thinks of the photos so far. */
export type Progress = {
  scores: Scores;
  /** What the best further photo would add. */
  gainLeft: Scores;
  isEnough: boolean;
  /** How much of what lies beside the object is taken for it, 0 to 1. */
  clutter: number;
};

/** Exact scores after each photo. */
export type Curve = { coverage: number[]; diversity: number[] };
export type Curves = Record<Rival | "planner", Curve>;

/** An export, ready to be saved. */
export type Parcel = { blob: Blob; name: string; photos: number; checks: string[] };

export type Named = { path: string; file: Blob };

export type ImportReport = {
  name: string;
  /** Which program's layout it is. */
  origin: string;
  photos: { path: string; pose: Float32Array }[];
  skipped: { path: string; why: string }[];
  notes: string[];
  layout: Layout;
  scores: Scores | null;
  gainLeft: Scores | null;
  isEnough: boolean;
  /** The views to take next, the best first, in words relative to a photo. */
  reshoot: Reshoot[];
  /** Whether it is a capture of this page, which can be gone on with. */
  canResume: boolean;
};

export type Reshoot = {
  pose: Float32Array; // the capture's coordinates
  planPose: Float32Array;
  reason: Objective;
  nearest: string;
  way: string;
  gain: number;
};

/** What the board's tracker found in a camera frame. */
export type Tracked = {
  width: number;
  height: number;
  corners: Float32Array[]; // of each tag, 8 numbers, pixels
  pose: Float32Array | null;
  rmsPx: number | null;
  isAmbiguous: boolean;
  lens: Lens | null;
  lensSource: "calibrated" | "assumed" | "given";
  quality: Quality | null;
};

export type { BoardSpec, Objective };
