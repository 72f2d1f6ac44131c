// Where a camera's pose comes from. Every source says which it is; the page shows how far to trust it.

import { Advice } from "../advice.js";
import { BOARD } from "../board.js";
import type { Client } from "../client.js";
import { type Lens, type Vec3, add, fromAxes, lensOf, radians, scale } from "../geometry.js";
import type { Layout } from "../layout.js";
import type { Tracked } from "../messages.js";
import type { PoseSource as Kind } from "../record.js";
import type { Video } from "./video.js";

/** A phone's usual horizontal field of view, where nothing better is known. */
const USUAL_FOV_RAD = radians(64);

export interface PoseSource {
  readonly kind: Kind;
  /** What shows the camera's picture; null where the system does, behind the page. */
  readonly picture: HTMLElement | null;
  /** Of a frame, pixels. */
  readonly size: { width: number; height: number };
  /** Waits for the next frame and looks at it, if it is still wanted then; what was found belongs to that very frame. */
  next(isWanted: () => boolean): Promise<Tracked | null>;
  stop(): void;
}

export const assumedLens = (width: number, height: number): Lens =>
  // The field of view is that of the longer side.
  ({ ...lensOf(width, height, 1), ...focal((0.5 * Math.max(width, height)) / Math.tan(0.5 * USUAL_FOV_RAD)) });

const focal = (pixels: number): { fx: number; fy: number } => ({ fx: pixels, fy: pixels });

/** Poses from the printed board: six degrees of freedom, metric. */
export class BoardSource implements PoseSource {
  readonly kind = "board";
  readonly picture: HTMLElement;

  constructor(private client: Client, private video: Video) {
    this.picture = video.element;
  }

  get size(): { width: number; height: number } {
    return this.video.size;
  }

  async next(isWanted: () => boolean): Promise<Tracked | null> {
    const frame = await this.video.next(isWanted);
    return frame && (await this.client.ask({ type: "track", spec: BOARD, frame }, [frame])).tracked;
  }

  stop(): void {
    this.video.stop();
  }
}

/** Only which way the camera looks: the distance to the object is assumed, and said to be. */
export class OrientationSource implements PoseSource {
  readonly kind = "orientation";
  readonly picture: HTMLElement;
  private latest: { alpha: number; beta: number; gamma: number } | null = null;
  private listen = ({ alpha, beta, gamma }: DeviceOrientationEvent): void => {
    if (alpha !== null && beta !== null && gamma !== null) this.latest = { alpha, beta, gamma };
  };

  private constructor(private client: Client, private video: Video, private layout: Layout) {
    this.picture = video.element;
    window.addEventListener("deviceorientation", this.listen);
  }

  /** Must be called from a tap: iOS asks for permission. */
  static async open(client: Client, video: Video, layout: Layout): Promise<OrientationSource> {
    const events = globalThis.DeviceOrientationEvent as (typeof DeviceOrientationEvent & { requestPermission?: () => Promise<string> }) | undefined;
    if (!events) throw new Advice("This device has no orientation sensor. Print the board instead: it works everywhere.");
    if (events.requestPermission && (await events.requestPermission()) !== "granted") {
      throw new Advice("The orientation sensor was refused. Allow motion access for this page, or print the board instead.");
    }
    const source = new OrientationSource(client, video, layout);
    for (let waited = 0; source.latest === null && waited < 1500; waited += 50) {
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    if (source.latest === null) {
      source.stop();
      throw new Advice("This device tells no orientation. Print the board instead: it works everywhere.");
    }
    return source;
  }

  get size(): { width: number; height: number } {
    return this.video.size;
  }

  async next(isWanted: () => boolean): Promise<Tracked | null> {
    const frame = await this.video.next(isWanted);
    if (!frame) return null;
    const lens = assumedLens(frame.width, frame.height);
    const { tracked } = await this.client.ask({ type: "track", spec: null, frame }, [frame]);
    if (this.latest === null) return tracked;
    const angle = globalThis.screen?.orientation?.angle ?? 0;
    return { ...tracked, pose: orientationPose(this.latest, radians(angle), this.layout), lens };
  }

  stop(): void {
    this.video.stop();
    window.removeEventListener("deviceorientation", this.listen);
  }
}

/**
 * A pose that looks at the object's middle from the planned distance, from the angles of the W3C's
 * Device Orientation specification (degrees): world_from_device = Rz(alpha) Rx(beta) Ry(gamma). The
 * device's axes (right, top, out of the screen) are those of its rear camera.
 */
export function orientationPose(
  { alpha, beta, gamma }: { alpha: number; beta: number; gamma: number }, screenRad: number, layout: Layout,
): Float32Array {
  const [a, b, c] = [radians(alpha), radians(beta), radians(gamma)];
  const [ca, sa, cb, sb, cc, sc] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b), Math.cos(c), Math.sin(c)];
  const x: Vec3 = [ca * cc - sa * sb * sc, sa * cc + ca * sb * sc, -cb * sc];
  const y: Vec3 = [-sa * cb, ca * cb, sb];
  const z: Vec3 = [ca * sc + sa * sb * cc, sa * sc - ca * sb * cc, cb * cc];
  // The picture turns with the screen.
  const [cs, ss] = [Math.cos(screenRad), Math.sin(screenRad)];
  const right: Vec3 = add(scale(x, cs), scale(y, -ss));
  const top: Vec3 = add(scale(x, ss), scale(y, cs));
  return fromAxes(add(layout.centre, scale(z, layout.distance)), right, top, z);
}
