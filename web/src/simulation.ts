// The simulated capture's camera: renders what the planner asks for, and shows the way there.

import type { Client } from "./client.js";
import { RIM } from "./dome.js";
import { type Pose, type Vec3, add, angleBetween, lookingAt, poseAt, position, scale, unit } from "./geometry.js";
import { DISTANCE } from "./layout.js";
import { type CaptureView, type Faces, RIVALS, type Shot } from "./messages.js";
import { Stage, builtIn } from "./scene/stage.js";
import type { State } from "./state.js";

/** How long the camera takes from one view to the next, milliseconds. */
const TRAVEL_MS = 420;

export class Simulation {
  private shown: Float32Array | null = null;
  private travel: Promise<void> = Promise.resolve();
  private heading: Float32Array | null = null;
  /** The object as far as it can be seen from the candidates; null until that is known. */
  private known: Reachable | null = null;

  private constructor(private stage: Stage) {}

  /** The built-in object, or a GLB file's. */
  static async open(file: Blob | null): Promise<Simulation> {
    const stage = new Stage();
    if (file) {
      const { UPRIGHT, readGlb } = await import("./scene/glb.js");
      stage.setObject(await readGlb(file), UPRIGHT);
    } else {
      stage.setObject(await builtIn());
    }
    return new Simulation(stage);
  }

  /** Gives the worker the mesh, and the faces of the photos that there are already. */
  async *replay(client: Client, view: CaptureView): AsyncGenerator<CaptureView> {
    this.known ??= await this.reach(view);
    const triangles = this.known.triangles.slice();
    let answer = await client.ask({ type: "mesh", triangles }, [triangles.buffer]);
    yield answer.view;
    for (const [index, photo] of view.record.photos.entries()) {
      const faces = await this.faces(view, index, photo.pose);
      answer = await client.ask({ type: "faces", number: photo.number, faces });
    }
    yield answer.view;
  }

  /** The planner's next photo, with what is needed for the curves. */
  async shoot(view: CaptureView): Promise<Shot> {
    if (!view.next) throw new Error("There is no next view.");
    const { pose, index } = view.next;
    const faces = await this.faces(view, view.record.photos.length, pose);
    return { picture: await this.stage.photo(pose), format: "png", pose, candidate: index, source: "simulated", faces };
  }

  /** What no candidate sees, such as the bottom, counts for nobody: it would only hide how much of
   *  the rest is there. */
  private async reach(view: CaptureView): Promise<Reachable> {
    const all = this.stage.triangles;
    const isSeen = new Uint8Array(all.length / 9 + 1);
    for (let index = 0; 12 * index < view.candidates.length; index += 1) {
      for (const id of await this.stage.faces(poseAt(view.candidates, index))) isSeen[id] = 1;
    }
    isSeen[0] = 0;
    const numbers = new Uint32Array(isSeen.length);
    const triangles: number[] = [];
    let count = 0;
    isSeen.forEach((seen, id) => {
      if (!seen) return;
      count += 1;
      numbers[id] = count;
      for (let i = 9 * (id - 1); i < 9 * id; i += 1) triangles.push(all[i] ?? 0);
    });
    return { triangles: Float32Array.from(triangles), numbers };
  }

  private async ids(pose: Pose): Promise<Uint32Array> {
    const ids = await this.stage.faces(pose);
    return this.known ? ids.map((id) => this.known?.numbers[id] ?? 0) : ids;
  }

  private async faces(view: CaptureView, photo: number, pose: Pose): Promise<Faces> {
    const faces: Faces = { planner: await this.ids(pose) };
    for (const rival of RIVALS) {
      const poses = view.rivalPoses?.[rival];
      if (poses && poses.length >= 12 * (photo + 1)) faces[rival] = await this.ids(poseAt(poses, photo));
    }
    return faces;
  }

  /** Draws the canvases of the page; the camera travels to the next view. */
  paint(state: State): void {
    if (state.screen !== "simulate") return;
    const side = document.querySelector<HTMLCanvasElement>("#in-dome");
    if (side) this.stage.showInDome(side, state.dome.azimuthRad, state.dome.elevationRad, RIM);
    const goal = state.view?.next?.pose ?? state.view?.record.photos.at(-1)?.pose;
    if (!goal) return;
    const pose = Float32Array.from(goal);
    if (this.heading && same(this.heading, pose) && this.shown) {
      this.draw(this.shown);
      return;
    }
    this.heading = pose;
    this.travel = this.travelTo(pose);
  }

  /** Resolves when the camera has arrived. */
  settle(): Promise<void> {
    return this.travel;
  }

  private async travelTo(goal: Float32Array): Promise<void> {
    const from = this.shown;
    const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (from && !isCalm) {
      const begin = performance.now();
      for (let share = 0; share < 1 && this.heading === goal; ) {
        const now = await new Promise<number>((resolve) => requestAnimationFrame(resolve));
        share = Math.min(1, Math.max(0, now - begin) / TRAVEL_MS);
        this.draw(between(from, goal, share * share * (3 - 2 * share)));
      }
    }
    if (this.heading === goal) this.draw(goal);
  }

  private draw(pose: Float32Array): void {
    this.shown = pose;
    const canvas = document.querySelector<HTMLCanvasElement>("#finder");
    if (canvas) this.stage.show(canvas, pose);
  }

  dispose(): void {
    this.heading = null;
    this.stage.dispose();
  }
}

/** The triangles that some candidate sees, and the number + 1 of each by its own; 0 for the others. */
type Reachable = { triangles: Float32Array; numbers: Uint32Array };

const same = (a: Float32Array, b: Float32Array): boolean => a.every((value, index) => value === b[index]);

/** On the way round the object, always looking at it. */
function between(a: Float32Array, b: Float32Array, share: number): Float32Array {
  const [from, to] = [unit(position(a)), unit(position(b))];
  const angle = angleBetween(from, to);
  const sine = Math.sin(angle);
  const out: Vec3 = sine < 1e-4
    ? to
    : add(scale(from, Math.sin((1 - share) * angle) / sine), scale(to, Math.sin(share * angle) / sine));
  return lookingAt(scale(unit(out), DISTANCE), [0, 0, 0]);
}
