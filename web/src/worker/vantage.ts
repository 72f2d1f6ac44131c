// The part of `vantage-wasm` that the worker uses, and the loading of it with its network.

import type { Finish, NextView, Objective, Plan, Scores, Status, ViewSpace } from "../core.js";
import type { BoardSpec } from "../messages.js";
import type { Quality } from "../record.js";

export type Photo = { pixels: Uint8Array; width: number; height: number; format: "rgb" | "rgba" | "luma" };

export interface Model { readonly checksum: number; free(): void }
export interface Pool { readonly length: number; poses(): Float32Array; free(): void }
export interface Session {
  observe(index: number, photo?: Photo, pose?: Float32Array): void;
  observeElsewhere(pose: Float32Array, photo?: Photo): void;
  block(index: number): void;
  unblock(index: number): void;
  skip(index: number): void;
  nextView(): NextView | undefined;
  finish(): Finish | undefined;
  gains(objective: Objective): Float32Array;
  progress(): { views: number; budget: number; scores: Scores; gainLeft: Scores; isEnough: boolean };
  statuses(): Status[];
  snapshot(): Uint8Array;
  replan(plan: Plan): void;
  poses(): Float32Array;
  free(): void;
}
export interface MeshLedger {
  observe(pose: Float32Array, faceIds: Uint32Array): void;
  scores(): { coverage: number; diversity: number };
  free(): void;
}
export interface BoardTracker {
  track(luma: Uint8Array, width: number, height: number): TrackResult;
  svg(page: "a4" | "letter"): string;
  free(): void;
}
export type TrackResult = {
  tags: { id: number; corners: Float32Array }[];
  pose?: Float32Array;
  rmsPx?: number;
  isAmbiguous?: boolean;
  focalPx: number;
  cx: number;
  cy: number;
  intrinsicsSource: "calibrated" | "assumed" | "given";
};

export interface Vantage {
  Model: new (bytes: Uint8Array) => Model;
  Pool: { new (space: ViewSpace, count: number, radiusM: number): Pool; fromPoses(poses: Float32Array): Pool };
  Session: {
    new (pool: Pool, plan: Plan, model?: Model): Session;
    restore(bytes: Uint8Array, model?: Model): Session;
  };
  MeshLedger: new (positions: Float32Array, indices: Uint32Array) => MeshLedger;
  BoardTracker?: new (spec: BoardSpec) => BoardTracker;
  frameQuality?: (luma: Uint8Array, width: number, height: number) => Quality;
}
