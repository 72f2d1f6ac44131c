// The camera screen at work: frame after frame is looked at, hints are told, photos are taken.

import { Advice } from "../advice.js";
import { type App, STOP } from "../app.js";
import { type Lens, type Pose, position, radians, subtract } from "../geometry.js";
import { type Layout, directionOf, fromPlan } from "../layout.js";
import type { CaptureView, Tracked } from "../messages.js";
import { reasonWords, way } from "../words.js";
import { AutoShutter, type Guide, LOST, type Reading, SharpnessMemory, guide, speed } from "./hints.js";
import { standing } from "./live-layout.js";
import { BoardSource, OrientationSource, type PoseSource, assumedLens } from "./source.js";
import { Video } from "./video.js";
import { Voice } from "./voice.js";
import type { XrSource } from "./xr/session.js";

/** Where the poses of a live capture come from. */
export type LiveSource = "board" | "webxr" | "orientation";

/** Candidates around a real object, and photos planned at first. */
const PLANNED = { count: 100, budget: 30, movementCost: 0.5 };

export class LiveCapture {
  readonly voice = new Voice();
  private source: PoseSource | null = null;
  /** The source, where it is the phone's own tracking. */
  private phone: XrSource | null = null;
  private running = new AbortController();
  private shutter = new AutoShutter();
  private sharpness = new SharpnessMemory();
  private awake: WakeLockSentinel | null = null;
  private last: { pose: Pose; at: number } | null = null;
  /** The frame that is being looked at. */
  private looking: Promise<Tracked | null> = Promise.resolve(null);

  constructor(private app: App) {}

  /** What shows the camera's picture on the page. */
  get picture(): HTMLElement | null {
    return this.source?.picture ?? null;
  }

  /** Opens the camera; begins a capture, or goes on with the one there is. */
  async start(kind: LiveSource, objectM: number, isNew: boolean): Promise<void> {
    this.stop();
    if (kind === "webxr") await this.openAr();
    else await this.openVideo(kind, objectM, isNew);
    const { source } = this;
    if (!source) return;
    this.app.dispatch({
      type: "lived",
      live: { source: kind, size: source.size, tracked: null, guide: null, placing: kind === "webxr" ? { objectM, aim: null } : null },
    });
    this.app.go("camera");
    // Photos should outlive a full disk, and the screen the walk around the object; both are favours.
    void navigator.storage?.persist?.();
    this.awake = (await navigator.wakeLock?.request("screen").catch(() => null)) ?? null;
    this.running = new AbortController();
    void this.look(this.running.signal);
  }

  private async openVideo(kind: "board" | "orientation", objectM: number, isNew: boolean): Promise<void> {
    const video = await Video.open();
    const lens = assumedLens(video.size.width, video.size.height);
    const layout = isNew ? standing(objectM, lens) : (this.app.state.view?.record.layout ?? standing(objectM, lens));
    const { client } = this.app;
    try {
      this.source = kind === "board" ? new BoardSource(client, video) : await OrientationSource.open(client, video, layout);
    } catch (error) {
      video.stop();
      throw error;
    }
    if (isNew) await this.begin(kind, layout, lens);
  }

  /** The capture begins later, once the object is placed: what was kept is kept until then. */
  private async openAr(): Promise<void> {
    const { XrSource } = await import("./xr/session.js");
    const source = await XrSource.open(this.app.client, document.body.querySelector("#app") ?? document.body);
    source.onEnd = (why) => this.ended(why);
    this.source = this.phone = source;
  }

  private async begin(kind: LiveSource, layout: Layout, lens: Lens): Promise<void> {
    const { view } = await this.app.client.ask({
      type: "start",
      setup: {
        name: "my object", subject: { kind: "camera", source: kind }, layout, lens,
        // Nothing below the table, nothing that needs a ladder.
        pool: {
          space: { kind: "hemisphere", minElevationRad: radians(8), maxElevationRad: radians(72) },
          count: PLANNED.count,
        },
        plan: { scheme: "support", budget: PLANNED.budget, movementCost: PLANNED.movementCost, stop: STOP },
      },
    });
    this.app.dispatch({ type: "discarded" });
    this.app.dispatch({ type: "captured", view });
  }

  stop(): void {
    this.running.abort();
    this.source?.stop();
    this.source = this.phone = null;
    void this.awake?.release();
    this.awake = null;
    this.last = null;
    this.voice.silence();
  }

  /** The system has ended AR, or has lost the place for good. */
  private ended(why: string): void {
    const { view, live } = this.app.state;
    const photos = live.placing ? 0 : (view?.record.photos.length ?? 0);
    this.app.go(photos > 0 ? "review" : "setup");
    const kept = photos === 0 ? "No photo had been taken." : photos === 1 ? "The photo is kept." : `All ${photos} photos are kept.`;
    this.app.dispatch({ type: "noticed", notice: { level: "info", text: `${why} ${kept}` } });
  }

  private async look(signal: AbortSignal): Promise<void> {
    // While a photo is being kept the worker is busy, and the frame it keeps must stay.
    const isWanted = (): boolean => !signal.aborted && this.app.state.busy === null;
    while (!signal.aborted && this.source) {
      try {
        this.looking = this.source.next(isWanted);
        const tracked = await this.looking;
        if (tracked && !signal.aborted) await this.judge(tracked);
      } catch (error) {
        if (signal.aborted) return;
        this.app.say(error);
        await new Promise((resolve) => setTimeout(resolve, 1000));
      }
    }
  }

  /** One aim at the object's middle. The second, from further round, places it, and the capture begins. */
  place = (): Promise<void> =>
    this.app.doing("Placing the object", async () => {
      const { placing, tracked } = this.app.state.live;
      if (!placing || !this.phone) return;
      if (!tracked?.pose || !tracked.lens) throw new Advice(LOST.webxr);
      const { aimOf, middleOf } = await import("./xr/placing.js");
      const aim = aimOf(tracked.pose);
      if (placing.aim === null) {
        this.app.dispatch({ type: "lived", live: { placing: { ...placing, aim } } });
        return;
      }
      const middle = middleOf(placing.aim, aim, placing.objectM);
      const layout = standing(placing.objectM, tracked.lens);
      await this.begin("webxr", layout, tracked.lens);
      this.phone.anchor(subtract(middle, layout.centre));
      this.last = null;
      this.app.dispatch({ type: "lived", live: { placing: null, tracked: null } });
    });

  private async judge(tracked: Tracked): Promise<void> {
    const { view, live } = this.app.state;
    if (live.placing) return this.app.dispatch({ type: "lived", live: { tracked } });
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
      source: this.app.state.live.source, pose, quality, speedRadS, usualSharpness: this.sharpness.usual(), isAmbiguous: tracked.isAmbiguous,
      lens: tracked.lens ?? assumedLens(tracked.width, tracked.height),
    };
  }

  /** Takes the frame that was looked at last: its pose is its own. */
  shoot = (): Promise<void> =>
    this.app.doing("Keeping the photo", async () => {
      // A frame on its way to the worker replaces the one before: its pose must be known first.
      await this.looking.catch(() => null);
      const { view, live } = this.app.state;
      if (!view || !this.source || !live.tracked) return;
      const { pose, lens, rmsPx, width, height } = live.tracked;
      if (!pose) throw new Advice(`The photo was not taken, since nobody could tell where from. ${LOST[live.source]}`);
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
