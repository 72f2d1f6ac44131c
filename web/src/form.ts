// The form's fields as a request to start a plan.

import type { Plan, ViewSpace } from "./messages.js";

export type Order = { space: ViewSpace; count: number; radiusM: number; plan: Plan };

const DEGREE = Math.PI / 180;

/** What the fields ask for. Whether the numbers make sense is for the core to say. */
export function order(fields: (name: string) => string): Order {
  const number = (name: string): number => Number.parseFloat(fields(name));
  const seed = number("seed");
  return {
    space: viewSpace(fields("space"), seed),
    count: number("count"),
    radiusM: number("radiusM"),
    plan: { scheme: scheme(fields("scheme")), budget: number("budget"), seed },
  };
}

function viewSpace(kind: string, seed: number): ViewSpace {
  const above = { minElevationRad: 5 * DEGREE, maxElevationRad: 75 * DEGREE };
  switch (kind) {
    case "rings":
      return { kind, rings: 3, minElevationRad: 10 * DEGREE, maxElevationRad: 60 * DEGREE };
    case "spiral":
      return { kind, turns: 5, ...above };
    case "fibonacci-sphere":
      return { kind };
    case "random-sphere":
      return { kind, seed };
    default:
      return { kind: "hemisphere", ...above };
  }
}

function scheme(name: string): Plan["scheme"] {
  return name === "random" || name === "pseudo-coverage" ? name : "farthest-point";
}
