// Exact coverage and diversity of a simulated capture after each photo, beside what rings,
// farthest-point sampling and chance would have reached with as many.

import { poseAt } from "../geometry.js";
import { DISTANCE } from "../layout.js";
import { type Curve, type Curves, type Faces, RIVALS, type Rival } from "../messages.js";
import type { CaptureRecord } from "../record.js";
import type { MeshLedger, Vantage } from "./vantage.js";

const LANES = ["planner", ...RIVALS] as const;

export class Ledgers {
  private ledgers: Record<Rival | "planner", MeshLedger>;
  readonly curves: Curves;

  /** For an object's triangles, shape (faces, 3, 3), in the planner's coordinates. */
  constructor(core: Vantage, triangles: Float32Array, private rivalPoses: Record<Rival, Float32Array>) {
    const indices = Uint32Array.from({ length: triangles.length / 3 }, (_, index) => index);
    const each = <T>(make: () => T): Record<Rival | "planner", T> => ({
      planner: make(), rings: make(), farthest: make(), random: make(),
    });
    this.ledgers = each(() => new core.MeshLedger(triangles, indices));
    this.curves = each((): Curve => ({ coverage: [], diversity: [] }));
  }

  /** Takes in the next photo of the planner, and the rivals' photo of the same number. */
  add(pose: Float32Array, faces: Faces): void {
    const photo = this.curves.planner.coverage.length;
    for (const lane of LANES) {
      const seen = faces[lane];
      if (!seen) continue;
      const from = lane === "planner" ? pose : poseAt(this.rivalPoses[lane], photo);
      this.ledgers[lane].observe(from, seen);
      const { coverage, diversity } = this.ledgers[lane].scores();
      this.curves[lane].coverage.push(coverage);
      this.curves[lane].diversity.push(diversity);
    }
  }

  free(): void {
    for (const lane of LANES) this.ledgers[lane].free();
  }
}

/** Where the rivals would stand, photo by photo, for the same number of photos. */
export function rivals(core: Vantage, { pool, plan }: CaptureRecord): Record<Rival, Float32Array> {
  const { budget } = plan;
  const seed = plan.seed ?? 0;
  const sequence = (scheme: "farthest-point" | "random"): Float32Array => {
    const candidates = new core.Pool(pool.space, pool.count, DISTANCE);
    const session = new core.Session(candidates, { scheme, budget, seed });
    const poses: number[] = [];
    for (let next = session.nextView(); next; next = session.nextView()) {
      poses.push(...next.pose);
      session.observe(next.index);
    }
    session.free();
    candidates.free();
    return Float32Array.from(poses);
  };
  const { space } = pool;
  const limits = "minElevationRad" in space ? space : { minElevationRad: 0.1, maxElevationRad: 1.2 };
  const rings = new core.Pool(
    { kind: "rings", rings: 3, minElevationRad: limits.minElevationRad, maxElevationRad: limits.maxElevationRad },
    budget,
    DISTANCE,
  );
  const ringPoses = rings.poses();
  rings.free();
  return { rings: ringPoses, farthest: sequence("farthest-point"), random: sequence("random") };
}
