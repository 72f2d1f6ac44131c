// What is kept of a capture: the record that is stored after every photo and, made readable, is
// `capture.json` of the export. instant-ngp reads every .json of a folder and skips those without
// `frames`: the top level must not have a key `frames`, `aabb`, `scale`, `offset` or `up`.

import type { Plan, Reason, Scores, ViewSpace } from "./core.js";
import type { Lens } from "./geometry.js";
import type { Layout } from "./layout.js";

export const FORMAT = "vantage-capture";
export const VERSION = 1;

/** How a photo's pose is known. */
export type PoseSource = "simulated" | "board" | "webxr" | "orientation" | "file";

/** How far a source's poses are to be trusted; shown beside it, and written into the export. */
export const TRUST: Record<PoseSource, { title: string; trust: string }> = {
  simulated: { title: "Simulated", trust: "exact" },
  board: { title: "Printed board", trust: "about 1° and 2 % of the distance; metric" },
  webxr: { title: "Phone tracking (WebXR)", trust: "a few centimetres; may drift; metric" },
  orientation: {
    title: "Direction only",
    trust: "a guess: the distance is assumed, so trainers must find the poses themselves",
  },
  file: { title: "Imported", trust: "as good as the program that wrote them" },
};

export type Quality = { sharpness: number; meanLuma: number; darkShare: number; brightShare: number };

export type PhotoRecord = {
  /** From 1; unique in the capture, also after photos were deleted. */
  number: number;
  /** The file's name below `images/`. */
  file: string;
  bytes: number;
  takenAt: string;
  /** The candidate it was taken for; null for a photo from anywhere else. */
  candidate: number | null;
  /** `world_from_camera`, the capture's coordinates, 12 numbers. */
  pose: number[];
  source: PoseSource;
  /** The focal length, in pixels, that the pose was found with: a lens calibrates itself on the way. */
  focalPx: number;
  /** Reprojection error of the board, pixels. */
  rmsPx?: number;
  quality?: Quality;
  /** The estimated scores once it was taken, and what it added to each. */
  scores: Scores | null;
  gain: Scores | null;
  /** Why it was asked for; null where the photographer chose. */
  reason: Reason | null;
};

export type Subject =
  | { kind: "built-in" }
  | { kind: "file"; name: string }
  | { kind: "camera"; source: PoseSource };

export type CaptureRecord = {
  format: typeof FORMAT;
  version: typeof VERSION;
  name: string;
  startedAt: string;
  subject: Subject;
  layout: Layout;
  lens: Lens;
  pool: { space: ViewSpace; count: number };
  plan: Plan;
  /** The number of the next photo. */
  nextNumber: number;
  photos: PhotoRecord[];
};

/** Whether a value read from outside is a record of this version; a sentence if not. */
export function checkRecord(value: unknown): CaptureRecord {
  const record = value as Partial<CaptureRecord> | null;
  if (typeof record !== "object" || record === null || record.format !== FORMAT) {
    throw new Error("this is not a capture of this page");
  }
  if (record.version !== VERSION) {
    throw new Error(`the capture was written by another version (${String(record.version)}) of this page`);
  }
  const isWhole =
    Array.isArray(record.photos) &&
    record.photos.every((p) => Array.isArray(p.pose) && p.pose.length === 12 && p.pose.every(Number.isFinite)) &&
    typeof record.layout === "object" && typeof record.lens === "object" &&
    typeof record.plan === "object" && typeof record.pool === "object" && typeof record.subject === "object";
  if (!isWhole) throw new Error("the capture's record is damaged");
  return record as CaptureRecord;
}
