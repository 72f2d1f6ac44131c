import { expect, it } from "vitest";
import type { CaptureView } from "../src/messages.js";
import { type State, canTake, initial, next } from "../src/state.js";
import { isSoft } from "../src/view/review.js";
import { instruction } from "../src/view/camera.js";
import { lookingAt } from "../src/geometry.js";
import { record } from "./record.js";

const viewOf = (numbers: number[]): CaptureView => ({
  record: {
    ...record("mine"),
    photos: numbers.map((number) => ({
      number, file: `${number}.png`, bytes: 9, takenAt: "", candidate: number, pose: [...lookingAt([3, 0, 0], [0, 0, 0])],
      source: "simulated", focalPx: 1, scores: null, gain: null, reason: "coverage",
    })),
  },
  candidates: new Float32Array(), statuses: [], finish: null, progress: null, curves: null, rivalPoses: null, room: null,
  next: { index: 3, pose: lookingAt([0, 3, 0], [0, 0, 0]), gain: 0.1, reason: "coverage", why: "" },
});

const after = (state: State, ...events: Parameters<typeof next>[1][]): State => events.reduce(next, state);

it("what was derived from other photos goes when photos come or go", () => {
  const parcel = { url: "blob:x", name: "a.zip", photos: 2, checks: [], size: 1 };
  const state = after(
    initial, { type: "captured", view: viewOf([1, 2]) }, { type: "pictured", number: 1, url: "a" }, { type: "pictured", number: 2, url: "b" },
    { type: "ranked", order: [2, 1] }, { type: "packed", parcel }, { type: "selected", number: 2 },
  );
  const same = next(state, { type: "captured", view: viewOf([1, 2]) });
  expect([same.parcel, same.best?.count]).toEqual([parcel, 2]);
  const fewer = next(state, { type: "captured", view: viewOf([1]) });
  expect([fewer.parcel, fewer.best, fewer.selected]).toEqual([null, null, null]);
  expect([...fewer.thumbnails.keys()]).toEqual([1]);
});

it("a photo can be taken only while nothing else is done", () => {
  const state = next(initial, { type: "captured", view: viewOf([]) });
  expect(canTake(state)).toBe(true);
  expect(canTake(next(state, { type: "began", what: "Something" }))).toBe(false);
  expect(canTake(initial)).toBe(false);
});

it("going elsewhere closes messages; the dome does not turn over", () => {
  const state = after(initial, { type: "noticed", notice: { level: "error", text: "no" } }, { type: "went", screen: "review" });
  expect(state.notice).toBeNull();
  expect(next(state, { type: "turned", azimuthRad: 0, elevationRad: 9 }).dome.elevationRad).toBe(Math.PI / 2);
});

it("a photo is soft beside sharper ones, and none without knowledge", () => {
  const { photos } = viewOf([1, 2, 3]).record;
  const [one, two, three] = photos.map((photo, i) => ({ ...photo, quality: { sharpness: [1, 0.9, 0.1][i] ?? 0, meanLuma: 99, darkShare: 0, brightShare: 0 } }));
  if (!one || !two || !three) throw new Error("three photos are due");
  expect([one, two, three].map((photo) => isSoft(photo, [one, two, three]))).toEqual([false, false, true]);
  expect(photos.some((photo) => isSoft(photo, photos))).toBe(false);
});

it("the camera's one line says the way, and to hold still", () => {
  const view = viewOf([]);
  const pose = lookingAt([3, 0, 0], [0, 0, 0]);
  const tracked = { width: 1, height: 1, corners: [], pose, rmsPx: 0, isAmbiguous: false, lens: null, lensSource: "assumed" as const, quality: null };
  const guide = { target: { x: 0, y: 0 }, toGoRad: 1, isInZone: false, hints: [], isReady: false };
  expect(instruction(view, { ...initial.live, tracked, guide })).toBe("Move 90° to the right");
  expect(instruction(view, { ...initial.live, tracked, guide: { ...guide, isInZone: true, isReady: true } })).toBe("Hold still…");
  expect(instruction(view, { ...initial.live, tracked: { ...tracked, pose: null }, guide })).toBe("Point at the board");
});
