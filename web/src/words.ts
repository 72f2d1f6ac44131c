// What the planner's reasons and places mean to a photographer.

import { type Vec3, degrees } from "./geometry.js";
import type { Finish, Objective, Reason } from "./core.js";

/** Why the next view is worth taking, as a sentence. */
export function reasonWords(reason: Reason): string {
  switch (reason) {
    case "coverage":
      return "Most new surface expected from here.";
    case "geometry":
      return "Fine shape here deserves another look.";
    case "diversity":
      return "This side has been seen from too few angles.";
    case "texture":
      return "This side looks detailed.";
    case "all-objectives":
      return "Best of everything together from here.";
    case "support":
      return "Least seen from near here so far.";
    case "farthest":
      return "Far from every photo so far.";
    case "start":
      return "A first look from this side.";
    case "chance":
      return "Chosen by chance.";
  }
}

/** From so much clutter on, outlines are not to be relied on. */
const CLUTTERED = 0.1;

/** What a background that is taken for the object means, if it is. */
export function clutterWords(clutter: number): string | null {
  if (clutter <= CLUTTERED) return null;
  return `${percent(clutter)} of what lies beside the object looks like part of it, so views are only spread evenly. A plain background helps.`;
}

/** Why there is no next view. */
export function finishWords(finish: Finish): string {
  switch (finish) {
    case "budget-spent":
      return "All planned photos are taken.";
    case "good-enough":
      return "Further photos would add very little: this is enough.";
    case "nothing-left":
      return "Every other place is out of reach.";
  }
}

export const OBJECTIVES: readonly { name: Objective; title: string; says: string }[] = [
  { name: "coverage", title: "Coverage", says: "how much of the surface has been seen" },
  { name: "geometry", title: "Shape", says: "how well fine shape has been seen" },
  { name: "diversity", title: "Angles", says: "from how many directions it has been seen" },
  { name: "texture", title: "Texture", says: "how well fine texture has been seen" },
];

/** Where a direction from the object points: degrees around from +X, and above the horizon. */
export function direction([x, y, z]: Vec3): { azimuthDeg: number; elevationDeg: number } {
  return { azimuthDeg: degrees(Math.atan2(y, x)), elevationDeg: degrees(Math.atan2(z, Math.hypot(x, y))) };
}

/** Steeper than this, a direction has no side to speak of. */
const STEEP_DEG = 75;

/**
 * The way from one direction to another, both from the object's middle, for someone who stands at
 * `from` and faces the object: "30° to the right, slightly higher". Turns are rounded to `stepDeg`.
 */
export function way(from: Vec3, to: Vec3, stepDeg = 1): string {
  const [a, b] = [direction(from), direction(to)];
  if (b.elevationDeg > STEEP_DEG) return "to nearly straight above";
  if (b.elevationDeg < -STEEP_DEG) return "to nearly straight below";
  // Who faces the object has growing azimuths on the right-hand side.
  const turn = ((b.azimuthDeg - a.azimuthDeg + 900) % 360) - 180;
  const rise = b.elevationDeg - a.elevationDeg;
  const size = Math.abs(rise) < 15 ? "slightly " : Math.abs(rise) > 40 ? "much " : "";
  const height = Math.abs(rise) < 2.5 ? "" : `${size}${rise > 0 ? "higher" : "lower"}`;
  const side = Math.abs(turn) > 170 ? "to the opposite side" : `${stepDeg * Math.max(1, Math.round(Math.abs(turn) / stepDeg))}° to the ${turn > 0 ? "right" : "left"}`;
  if (Math.abs(turn) < 2.5) return height === "" ? "right here" : height;
  return height === "" ? side : `${side}, ${height}`;
}

/** A share as people read it: "0.4 %", "12 %". */
export function percent(share: number): string {
  const value = 100 * share;
  return `${Math.abs(value) < 0.95 ? value.toFixed(1) : Math.round(value)} %`;
}

/** A number of bytes as people read it; number and unit stay on one line. */
export function bytes(count: number): string {
  if (count < 1e6) return `${Math.max(1, Math.round(count / 1e3))}\u00a0kB`;
  return count < 1e9 ? `${(count / 1e6).toFixed(1)}\u00a0MB` : `${(count / 1e9).toFixed(1)}\u00a0GB`;
}
