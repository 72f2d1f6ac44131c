// Where an object on the board stands, and from how far it is photographed.

import type { Layout } from "../layout.js";

/** An object of a size in the board's middle, photographed so that it fills the picture well. */
export function standing(objectM: number, lens: { width: number; height: number; fx: number }): Layout {
  const radius = 0.55 * objectM;
  const halfFov = Math.atan((0.5 * Math.min(lens.width, lens.height)) / lens.fx);
  return {
    centre: [0, 0, 0.4 * objectM], radius, up: [0, 0, 1],
    // Not nearer than a phone focuses.
    distance: Math.max(0.18, (1.15 * radius) / Math.sin(halfFov)),
  };
}
