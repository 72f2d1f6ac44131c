// The types of `vantage-wasm` that the page speaks of, and nothing else of it.

export type Objective = "coverage" | "geometry" | "diversity" | "texture";
export type Scheme = "ensemble" | "sum" | Objective | "farthest-point" | "random" | "pseudo-coverage";
export type Reason = Objective | "start" | "chance" | "farthest" | "all-objectives";
export type Finish = "budget-spent" | "good-enough" | "nothing-left";
export type Status = "available" | "visited" | "skipped" | "blocked";
export type Scores = Record<Objective, number>;

export type ViewSpace =
  | { kind: "random-sphere"; seed: number }
  | { kind: "fibonacci-sphere" }
  | { kind: "hemisphere"; minElevationRad: number; maxElevationRad: number }
  | { kind: "rings"; rings: number; minElevationRad: number; maxElevationRad: number }
  | { kind: "spiral"; turns: number; minElevationRad: number; maxElevationRad: number };

export type Plan = {
  scheme: Scheme;
  budget: number;
  seed?: number;
  movementCost?: number;
  stop?: { gain: number; patience: number };
};

export type NextView = { index: number; pose: Float32Array; gain: number; reason: Reason };
