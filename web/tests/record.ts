// A capture's record for tests.

import { lensOf } from "../src/geometry.js";
import { PLAIN } from "../src/layout.js";
import { type CaptureRecord, FORMAT, VERSION } from "../src/record.js";

export const record = (name: string): CaptureRecord => ({
  format: FORMAT, version: VERSION, name, startedAt: "2026-01-01T00:00:00Z", subject: { kind: "built-in" },
  layout: PLAIN, lens: lensOf(64, 64, 0.7), pool: { space: { kind: "fibonacci-sphere" }, count: 9 },
  plan: { scheme: "ensemble", budget: 4 }, nextNumber: 1, photos: [],
});
