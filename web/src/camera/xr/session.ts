// Poses and pictures from the phone's own tracking: a WebXR `immersive-ar` session. The system shows the
// camera's picture behind the page, which is the session's DOM overlay.

import { Advice } from "../../advice.js";
import type { Client } from "../../client.js";
import type { Lens, Vec3 } from "../../geometry.js";
import type { Tracked } from "../../messages.js";
import type { PoseSource } from "../source.js";
import { lensOfProjection, poseOf } from "./frame.js";
import { CameraPicture, cameraOf } from "./picture.js";

/** Tracking starts within a few seconds where there is anything to see. */
const PATIENCE_MS = 10_000;
const NO_PICTURES = "This browser tells where the phone is in AR, but gives pages no pictures there. Print the board and start the camera: that works everywhere.";

type Seen = { pose: Float32Array; lens: Lens; pixels: ImageData };

export class XrSource implements PoseSource {
  readonly kind = "webxr";
  /** Behind the page, not in it. */
  readonly picture = null;
  size = { width: 3, height: 4 };
  /** Called when the session ends other than by `stop`, with a sentence that says why. */
  onEnd: (why: string) => void = () => undefined;
  private origin: Vec3 = [0, 0, 0];
  private isOver = false;
  private waiting: ((frame: XRFrame | null) => void) | null = null;

  private constructor(
    private client: Client, private session: XRSession, private space: XRReferenceSpace,
    private gl: WebGL2RenderingContext, private layer: XRWebGLLayer, private camera: CameraPicture,
  ) {
    session.addEventListener("end", () => this.end("AR has ended."));
    // All later poses would be in other coordinates than the photos so far.
    space.addEventListener("reset", () => {
      this.end("The phone has lost its place, so AR has ended.");
      void session.end().catch(() => undefined);
    });
    session.requestAnimationFrame(this.tick);
  }

  /** Must be called from a tap. `overlay` is shown over the camera's picture. */
  static async open(client: Client, overlay: Element): Promise<XrSource> {
    const session = await request(overlay);
    let source: XrSource | null = null;
    try {
      if (!CameraPicture.isOffered() || session.enabledFeatures?.includes("camera-access") === false) throw new Advice(NO_PICTURES);
      const gl = document.createElement("canvas").getContext("webgl2", { xrCompatible: true });
      if (!gl) throw new Advice("AR needs WebGL 2, which this browser does not give. Print the board instead.");
      const layer = new XRWebGLLayer(session, gl);
      await session.updateRenderState({ baseLayer: layer });
      source = new XrSource(client, session, await session.requestReferenceSpace("local"), gl, layer, new CameraPicture(session, gl));
      await source.find();
      return source;
    } catch (error) {
      if (source) source.stop();
      else await session.end().catch(() => undefined);
      throw error;
    }
  }

  /** From now on poses are in a world whose origin lies there, in the world of the poses so far. */
  anchor([x, y, z]: Vec3): void {
    this.origin = [this.origin[0] + x, this.origin[1] + y, this.origin[2] + z];
  }

  async next(isWanted: () => boolean): Promise<Tracked | null> {
    const seen = await this.frame((frame) => (isWanted() ? this.see(frame) : undefined));
    if (seen === undefined) return null;
    if (seen === null) return { ...this.size, corners: [], pose: null, rmsPx: null, isAmbiguous: false, lens: null, lensSource: "given", quality: null };
    const { pose, lens, pixels } = seen;
    this.size = { width: lens.width, height: lens.height };
    const picture = await createImageBitmap(pixels, { imageOrientation: "flipY" });
    const { tracked } = await this.client.ask({ type: "track", spec: null, frame: picture }, [picture]);
    return { ...tracked, pose, lens, lensSource: "given" };
  }

  stop(): void {
    if (this.isOver) return;
    this.over();
    void this.session.end().catch(() => undefined);
  }

  /** Waits for the first view, and makes sure that it has a picture. */
  private async find(): Promise<void> {
    const end = performance.now() + PATIENCE_MS;
    while (performance.now() < end) {
      const view = await this.frame((frame) => this.viewOf(frame));
      if (view === undefined) throw new Advice("AR was closed before it began.");
      if (view === null) continue;
      const camera = cameraOf(view);
      if (!camera) throw new Advice(NO_PICTURES);
      this.size = { width: camera.width, height: camera.height };
      return;
    }
    throw new Advice("The phone does not find where it is. Go where it is light, point at something with a pattern, then start again.");
  }

  /** The system draws no new picture unless each frame is asked for. */
  private tick = (_: number, frame: XRFrame): void => {
    if (this.isOver) return;
    this.session.requestAnimationFrame(this.tick);
    const { gl, waiting } = this;
    this.waiting = null;
    waiting?.(frame);
    // Clear as glass: the camera's picture is behind it.
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.layer.framebuffer);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
  };

  /** What `look` makes of the next frame, within its callback; undefined once the session is over. */
  private frame<T>(look: (frame: XRFrame) => T): Promise<T | undefined> {
    return new Promise((resolve, reject) => {
      if (this.isOver) return resolve(undefined);
      this.waiting = (frame) => {
        try {
          resolve(frame ? look(frame) : undefined);
        } catch (error) {
          reject(error);
        }
      };
    });
  }

  /** The view with the camera; null while tracking is lost, also where only the direction is known. */
  private viewOf(frame: XRFrame): XRView | null {
    const viewer = frame.getViewerPose(this.space);
    if (!viewer || viewer.emulatedPosition) return null;
    return viewer.views.find((view) => cameraOf(view)) ?? viewer.views[0] ?? null;
  }

  private see(frame: XRFrame): Seen | null {
    const view = this.viewOf(frame);
    const camera = view && cameraOf(view);
    const pixels = camera && this.camera.read(camera);
    if (!view || !pixels) return null;
    return {
      pixels, pose: poseOf(view.transform.matrix, this.origin),
      lens: lensOfProjection(view.projectionMatrix, pixels.width, pixels.height),
    };
  }

  private end(why: string): void {
    if (this.isOver) return;
    this.over();
    this.onEnd(why);
  }

  private over(): void {
    this.isOver = true;
    this.waiting?.(null);
    this.waiting = null;
  }
}

async function request(overlay: Element): Promise<XRSession> {
  try {
    if (!navigator.xr) throw new DOMException("", "NotSupportedError");
    return await navigator.xr.requestSession("immersive-ar", {
      // Without the overlay nobody could press anything; without pictures the page says so.
      requiredFeatures: ["local", "dom-overlay"], optionalFeatures: ["camera-access"], domOverlay: { root: overlay },
    });
  } catch (error) {
    throw new Advice(sessionWords(error instanceof DOMException ? error.name : ""));
  }
}

/** Why AR did not begin, by the name of the browser's error. */
export function sessionWords(name: string): string {
  switch (name) {
    case "NotAllowedError":
      return "AR was refused. Allow camera and AR for this page (the icon beside the address), then start again.";
    case "NotSupportedError":
      return "This browser cannot show this page in AR. Print the board instead: it works everywhere.";
    case "SecurityError":
      return "The browser wants a fresh tap for AR: start once more.";
    case "InvalidStateError":
      return "Another page is in AR. Close that, then start again.";
    default:
      return "AR could not be started. Start again, or print the board instead.";
  }
}
