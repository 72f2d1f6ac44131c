// What a camera frame means for the person who holds the camera: which way to go, whether the place
// is reached, what is wrong with the picture and how to mend it. Pure, so that it can be tested.

import {
  type Lens, type Pose, type Vec3, angleBetween, cross, distance, dot, forward, length, position, project, radians, right, subtract,
  toCamera, unit, up,
} from "../geometry.js";
import type { Layout } from "../layout.js";
import type { PoseSource, Quality } from "../record.js";

/** A target is reached within this angle about the object: candidates lie about 13° apart, and the pose really
 *  reached is what counts. */
export const ZONE_RAD = radians(12);
/** Faster turns blur at a phone's usual exposure of 1/60 s: half a degree is some 8 pixels. */
const FASTEST_RAD_S = 0.5;
/** Distances in shares of the planned one. */
const [CLOSE, FAR] = [0.65, 1.6];
/** Sharpness in shares of what this scene has shown lately. */
const BLURRED = 0.45;
/** Means of luma, and shares of black and of blown-out pixels. */
const [DARK_LUMA, DARK_SHARE, BRIGHT_LUMA, BRIGHT_SHARE] = [38, 0.65, 210, 0.35];
/** The object's middle may lie so far from the picture's, in shares of its shorter side. */
const OFF_CENTRE = 0.3;

export type Hint = { level: "warn" | "stop"; name: HintName; text: string };
export type HintName = "lost" | "dark" | "bright" | "blurred" | "fast" | "close" | "far" | "aim" | "ambiguous";

const NO_BOARD = "The board is not in view. Show at least two whole tags.";
/** What to do where a source tells no pose. */
export const LOST: Record<PoseSource, string> = {
  board: NO_BOARD, simulated: NO_BOARD, file: NO_BOARD,
  webxr: "Tracking is lost. Move slowly, and show something lit and patterned.",
  orientation: "The orientation sensor is silent. Turn the phone a little.",
};

export type Reading = {
  source: PoseSource;
  pose: Pose | null;
  lens: Lens;
  quality: Quality | null;
  /** The sharpness that this scene usually shows; null while too few frames are known. */
  usualSharpness: number | null;
  speedRadS: number | null;
  isAmbiguous: boolean;
};

export type Guide = {
  /** Where the soft target lies in the picture, in [-1, 1] from its middle; null without a pose. */
  target: { x: number; y: number } | null;
  /** The angle about the object that is still to go. */
  toGoRad: number | null;
  isInZone: boolean;
  hints: Hint[];
  /** In the zone, with nothing wrong. */
  isReady: boolean;
};

export function guide(reading: Reading, goal: Pose | null, layout: Layout): Guide {
  const hints = picture(reading);
  const { pose } = reading;
  if (pose === null) {
    // Last, since the others are causes: in the dark, or blurred, no board is found.
    hints.push({ level: "stop", name: "lost", text: LOST[reading.source] });
    return { target: null, toGoRad: null, isInZone: false, hints, isReady: false };
  }
  hints.push(...place(reading, pose, layout));
  if (goal === null) return { target: null, toGoRad: null, isInZone: false, hints, isReady: false };
  const here = unit(subtract(position(pose), layout.centre));
  const there = unit(subtract(position(goal), layout.centre));
  const toGoRad = angleBetween(here, there);
  const isInZone = toGoRad <= ZONE_RAD;
  return { target: towards(pose, here, there, toGoRad), toGoRad, isInZone, hints, isReady: isInZone && hints.length === 0 };
}

/** The target wanders to the picture's middle as the camera comes near: 60° fill half the picture. */
function towards(pose: Pose, here: Vec3, there: Vec3, angle: number): { x: number; y: number } {
  // The way along the sphere, seen by the camera; straight opposite, any way will do.
  const along = cross(cross(here, there), here);
  const way: Vec3 = length(along) > 1e-6 ? unit(along) : right(pose);
  const reach = Math.min(0.8, angle / radians(75));
  const [x, y] = [dot(right(pose), way), dot(up(pose), way)];
  const norm = Math.hypot(x, y) || 1;
  return { x: (reach * x) / norm, y: (-reach * y) / norm };
}

function picture({ quality, usualSharpness, speedRadS }: Reading): Hint[] {
  const hints: Hint[] = [];
  const stop = (name: HintName, text: string): void => void hints.push({ level: "stop", name, text });
  if (quality !== null) {
    if (quality.meanLuma < DARK_LUMA || quality.darkShare > DARK_SHARE) stop("dark", "Too dark. Switch a light on or move to a window.");
    if (quality.meanLuma > BRIGHT_LUMA || quality.brightShare > BRIGHT_SHARE) stop("bright", "Too bright. Turn away from the light or close a curtain.");
  }
  if (speedRadS !== null && speedRadS > FASTEST_RAD_S) stop("fast", "Too fast. Slow down and hold still.");
  if (quality !== null && usualSharpness !== null && quality.sharpness < BLURRED * usualSharpness) stop("blurred", "Blurred. Hold still, tap the object to focus.");
  return hints;
}

function place({ lens, isAmbiguous }: Reading, pose: Pose, layout: Layout): Hint[] {
  const hints: Hint[] = [];
  const warn = (name: HintName, text: string): void => void hints.push({ level: "warn", name, text });
  const away = distance(position(pose), layout.centre) / layout.distance;
  if (away < CLOSE) warn("close", "Too close. Step back until the whole object shows.");
  if (away > FAR) warn("far", "Too far. Come closer.");
  if (isAmbiguous) warn("ambiguous", "The pose is unsure. Show more of the board.");
  const middle = project(lens, toCamera(pose, layout.centre));
  const short = Math.min(lens.width, lens.height);
  const off = middle ? Math.hypot(middle[0] - lens.width / 2, middle[1] - lens.height / 2) / short : 1;
  if (off > OFF_CENTRE) warn("aim", "Point the camera at the object.");
  return hints;
}

/** Fires once the camera has been ready for a while, then waits for the next target. */
export class AutoShutter {
  private since: number | null = null;
  private fired: number | null = null;

  /** Whether to take the photo now. `target` is the candidate's number, `now` in milliseconds. */
  feed(isReady: boolean, target: number | null, now: number): boolean {
    if (!isReady || target === null || target === this.fired) {
      this.since = null;
      return false;
    }
    this.since ??= now;
    if (now - this.since < STEADY_MS) return false;
    this.since = null;
    this.fired = target;
    return true;
  }

  /** How far the waiting has come, in [0, 1]. */
  share(now: number): number {
    return this.since === null ? 0 : Math.min(1, (now - this.since) / STEADY_MS);
  }

  /** The shot failed: the same target may be tried again. */
  again(): void {
    this.fired = null;
  }
}

/** So long must everything be right. */
export const STEADY_MS = 400;

/** The usual sharpness of a scene: a high one of the last few seconds. */
export class SharpnessMemory {
  private recent: number[] = [];

  feed(sharpness: number): void {
    this.recent.push(sharpness);
    if (this.recent.length > 60) this.recent.shift();
  }

  usual(): number | null {
    if (this.recent.length < 8) return null;
    const sorted = [...this.recent].sort((a, b) => a - b);
    return sorted[Math.floor(0.8 * sorted.length)] ?? null;
  }
}

/** How fast the view turns about the object or about itself. */
export function speed(a: Pose, b: Pose, layout: Layout, seconds: number): number {
  if (!(seconds > 0)) return 0;
  const turn = angleBetween(forward(a), forward(b));
  const round = angleBetween(subtract(position(a), layout.centre), subtract(position(b), layout.centre));
  return Math.max(turn, round) / seconds;
}
