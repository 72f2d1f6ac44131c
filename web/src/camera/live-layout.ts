// Where an object on the board stands, and from how far it is photographed.

import type { Layout } from "../layout.js";

/** So much around the object's middle should be in the picture, radius: most of the board's tags. */
const LEAST_SEEN_M = 0.11;

/** An object of a size in the board's middle, photographed so that it fills the picture well. */
export function standing(objectM: number, lens: { width: number; height: number; fx: number }): Layout {
  const radius = 0.55 * objectM;
  const halfFov = Math.atan((0.5 * Math.min(lens.width, lens.height)) / lens.fx);
  return {
    centre: [0, 0, 0.4 * objectM], radius, up: [0, 0, 1],
    // Not so near that a small object hides or crowds out the board.
    distance: (1.15 * Math.max(radius, LEAST_SEEN_M)) / Math.sin(halfFov),
  };
}
