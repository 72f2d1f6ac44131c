// The camera screen at work: frame after frame is looked at, hints are told, photos are taken.

import { Advice } from "../advice.js";
import { type App, STOP } from "../app.js";
import { type Pose, position, radians } from "../geometry.js";
import { type Layout, directionOf, fromPlan } from "../layout.js";
import type { CaptureView, Tracked } from "../messages.js";
import { reasonWords, way } from "../words.js";
import { AutoShutter, type Guide, type Reading, SharpnessMemory, guide, speed } from "./hints.js";
import { standing } from "./live-layout.js";
import { BoardSource, OrientationSource, type PoseSource, assumedLens } from "./source.js";
import { openCamera } from "./stream.js";
import { Voice } from "./voice.js";

/** Candidates around a real object, and photos planned at first. */
const PLANNED = { count: 100, budget: 30, movementCost: 0.25 };

export class LiveCapture {
  readonly video: HTMLVideoElement;
  readonly voice = new Voice();
  private source: PoseSource | null = null;
  private stream: MediaStream | null = null;
  private running = new AbortController();
  private shutter = new AutoShutter();
  private sharpness = new SharpnessMemory();
  private awake: WakeLockSentinel | null = null;
  private last: { pose: Pose; at: number } | null = null;

  constructor(private app: App) {
    this.video = document.createElement("video");
    Object.assign(this.video, { muted: true, playsInline: true, autoplay: true });
    this.video.setAttribute("aria-label", "The camera’s picture");
  }

  /** Opens the camera; begins a capture, or goes on with the one there is. */
  async start(kind: "board" | "orientation", objectM: number, isNew: boolean): Promise<void> {
    this.stop();
    this.stream = await openCamera();
    this.video.srcObject = this.stream;
    await this.video.play();
    const { videoWidth: width, videoHeight: height } = this.video;
    const lens = assumedLens(width, height);
    const layout = isNew ? standing(objectM, lens) : (this.app.state.view?.record.layout ?? standing(objectM, lens));
    try {
      this.source = kind === "board" ? new BoardSource(this.app.client) : await OrientationSource.open(this.app.client, layout);
    } catch (error) {
      this.stop();
      throw error;
    }
    if (isNew) {
      const { view } = await this.app.client.ask({
        type: "start",
        setup: {
          name: "my object", subject: { kind: "camera", source: kind }, layout, lens,
          // Nothing below the table, nothing that needs a ladder.
          pool: {
            space: { kind: "hemisphere", minElevationRad: radians(8), maxElevationRad: radians(72) },
            count: PLANNED.count,
          },
          plan: { scheme: "ensemble", budget: PLANNED.budget, movementCost: PLANNED.movementCost, stop: STOP },
        },
      });
      this.app.dispatch({ type: "discarded" });
      this.app.dispatch({ type: "captured", view });
    }
    this.app.dispatch({ type: "lived", live: { source: kind, size: { width, height }, tracked: null, guide: null } });
    this.app.go("camera");
    // Photos should outlive a full disk, and the screen the walk around the object; both are favours.
    void navigator.storage?.persist?.();
    this.awake = (await navigator.wakeLock?.request("screen").catch(() => null)) ?? null;
    this.running = new AbortController();
    void this.look(this.running.signal);
  }

  stop(): void {
    this.running.abort();
    this.source?.stop();
    this.source = null;
    for (const track of this.stream?.getTracks() ?? []) track.stop();
    this.stream = null;
    void this.awake?.release();
    this.awake = null;
    this.video.srcObject = null;
    this.voice.silence();
  }

  private async look(signal: AbortSignal): Promise<void> {
    while (!signal.aborted && this.source) {
      await nextFrame(this.video);
      // While a photo is being kept the worker is busy, and the frame it keeps must stay.
      if (signal.aborted || this.app.state.busy !== null || this.video.readyState < 2) continue;
      try {
        const frame = await createImageBitmap(this.video);
        const tracked = await this.source.read(frame);
        if (!signal.aborted) await this.judge(tracked);
      } catch (error) {
        if (signal.aborted) return;
        this.app.say(error);
        await new Promise((resolve) => setTimeout(resolve, 1000));
      }
    }
  }

  private async judge(tracked: Tracked): Promise<void> {
    const { view, live } = this.app.state;
    if (!view) return;
    const now = performance.now();
    const { layout } = view.record;
    const goal = view.next ? fromPlan(layout, view.next.pose) : null;
    const found = guide(this.reading(tracked, layout, now), goal, layout);
    const isDue = this.shutter.feed(found.isReady && live.isAutomatic, view.next?.index ?? null, now);
    this.app.dispatch({ type: "lived", live: { tracked, guide: found, steady: this.shutter.share(now) } });
    if (live.isSpoken) this.voice.say(spoken(view, tracked, found), found.hints[0]?.level === "stop");
    if (isDue) await this.shoot();
  }

  private reading(tracked: Tracked, layout: Layout, now: number): Reading {
    const { pose, quality } = tracked;
    const speedRadS = pose && this.last ? speed(this.last.pose, pose, layout, (now - this.last.at) / 1000) : null;
    this.last = pose ? { pose, at: now } : null;
    if (quality) this.sharpness.feed(quality.sharpness);
    return {
      pose, quality, speedRadS, usualSharpness: this.sharpness.usual(), isAmbiguous: tracked.isAmbiguous,
      lens: tracked.lens ?? assumedLens(tracked.width, tracked.height),
    };
  }

  /** Takes the frame that was looked at last: its pose is its own. */
  shoot = (): Promise<void> =>
    this.app.doing("Keeping the photo", async () => {
      const { view, live } = this.app.state;
      if (!view || !this.source || !live.tracked) return;
      const { pose, lens, rmsPx, width, height } = live.tracked;
      if (!pose) throw new Advice("The photo was not taken: without the board in view nobody can tell where from. Show at least two whole tags.");
      try {
        const answer = await this.app.client.ask({
          type: "shoot",
          shot: {
            picture: null, format: "jpg", pose, source: this.source.kind,
            candidate: live.guide?.isInZone ? (view.next?.index ?? null) : null,
            lens: lens ?? assumedLens(width, height),
            ...(rmsPx === null ? {} : { rmsPx }),
          },
        });
        this.app.dispatch({ type: "captured", view: answer.view });
        this.app.dispatch({ type: "lived", live: { flashes: live.flashes + 1 } });
        navigator.vibrate?.(60);
      } catch (error) {
        this.shutter.again();
        throw error;
      }
    });
}

/** What is said aloud: what is wrong, else which way to go. */
function spoken(view: CaptureView, tracked: Tracked, found: Guide): string {
  const [hint] = found.hints;
  if (hint && hint.level === "stop") return hint.text;
  if (!view.next || !tracked.pose) return "";
  if (found.isInZone) return hint ? hint.text : "Hold still.";
  const here = directionOf(view.record.layout, position(tracked.pose));
  return `Go ${way(here, position(view.next.pose), 10).replace(/°/g, " degrees")}. ${reasonWords(view.next.reason)}`;
}

function nextFrame(video: HTMLVideoElement): Promise<void> {
  return new Promise((resolve) => {
    // A hidden tab or a stalled camera brings no frames: look again now and then.
    const timer = setTimeout(resolve, 500);
    const done = (): void => {
      clearTimeout(timer);
      resolve();
    };
    if ("requestVideoFrameCallback" in video) video.requestVideoFrameCallback(done);
    else requestAnimationFrame(done);
  });
}
