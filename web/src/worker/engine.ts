// Answers the page's requests. No worker in here, so that tests can call it.

import { BOARD } from "../board.js";
import { resized } from "../geometry.js";
import type { Answer, Ask, BoardSpec, Engine as EngineInfo, Shot, Tracked } from "../messages.js";
import { Capture } from "./capture.js";
import type { Imported } from "./import.js";
import * as pictures from "./pictures.js";
import { Memory, type Store } from "./store.js";
import type { BoardTracker, Model, Vantage } from "./vantage.js";

/** Camera frames are looked at no larger than this, pixels: a tag of 40 mm at half a metre still has
 *  some 70 pixels a side. */
const TRACK_SIDE = 960;

export type Loaded = { core: Vantage; model: Model; build: EngineInfo["build"] };

export class Engine {
  private capture: Capture | null = null;
  private imported: Imported | null = null;
  private board: { key: string; tracker: BoardTracker } | null = null;
  /** The camera frame that was looked at last. */
  private frame: ImageBitmap | null = null;

  constructor(private loaded: Loaded, private store: Store) {}

  async answer(ask: Ask): Promise<Answer> {
    const { core, model, build } = this.loaded;
    switch (ask.type) {
      case "open": {
        return { type: "opened", engine: { build, storage: this.store.kind }, kept: await Capture.kept(this.store) };
      }
      case "start":
        return this.replace(await Capture.start(core, model, this.store, ask.setup));
      case "resume":
        return this.replace(await Capture.resume(core, model, this.store));
      case "discard":
        this.capture?.free();
        this.capture = null;
        await this.store.clear();
        return { type: "done" };
      case "mesh":
        this.current().setMesh(ask.triangles);
        return this.shown();
      case "faces":
        this.current().addFaces(ask.number, ask.faces);
        return this.shown();
      case "shoot":
        await this.current().shoot(ask.shot, this.pictureOf(ask.shot));
        return this.shown();
      case "skip":
        await this.current().skip(ask.candidate);
        return this.shown();
      case "block":
        await this.current().block(ask.candidate);
        return this.shown();
      case "more":
        await this.current().more(ask.views);
        return this.shown();
      case "delete":
        await this.current().delete(ask.number);
        return this.shown();
      case "best":
        return { type: "best", order: await this.current().best() };
      case "photo":
        return { type: "photo", blob: await this.current().photoFile(ask.number) };
      case "subject":
        return { type: "subject", blob: await this.store.get("subject") };
      case "export": {
        await this.refine();
        const { exportCapture } = await import("./export.js");
        return { type: "exported", parcel: await exportCapture(this.current()) };
      }
      case "import": {
        const { importCapture } = await import("./import.js");
        this.imported = await importCapture(core, model, ask.files);
        return { type: "imported", report: this.imported.report };
      }
      case "adopt":
        return this.replace(await this.adopt());
      case "board":
        return { type: "board", svg: this.trackerOf(ask.spec).svg(ask.page) };
      case "track":
        return { type: "tracked", tracked: this.track(ask.spec, ask.frame) };
    }
  }

  private current(): Capture {
    if (!this.capture) throw new Error("There is no capture yet: start one.");
    return this.capture;
  }

  private async replace(capture: Capture): Promise<Answer> {
    this.capture?.free();
    this.capture = capture;
    return this.shown();
  }

  private async shown(): Promise<Answer> {
    return { type: "capture", view: await this.current().view() };
  }

  /** Puts the photos of an imported capture of this page into the store. */
  private async adopt(): Promise<Capture> {
    const { core, model } = this.loaded;
    const record = this.imported?.record;
    if (!this.imported || !record) throw new Error("There is no capture of this page to go on with.");
    // First into memory: a damaged file is found before what was kept is removed.
    const read = new Memory();
    const { adoptFiles } = await import("./adopt.js");
    await adoptFiles(read, record, this.imported.entries);
    await this.store.clear();
    for (const [name, bytes] of read.all()) await this.store.put(name, bytes);
    return Capture.adopt(core, model, this.store, record);
  }

  /** Poses of photos taken before the lens had calibrated itself, with the lens as it is known now. */
  private async refine(): Promise<void> {
    let tracker: BoardTracker | null = null;
    await this.current().refine(async (photo, lens) => {
      const bitmap = await pictures.decode(photo);
      const picture = pictures.pixelsOf(bitmap, TRACK_SIDE);
      bitmap.close();
      const { fx, cx, cy } = resized(lens, picture.width, picture.height);
      tracker ??= new this.loaded.core.BoardTracker(BOARD);
      tracker.setIntrinsics(fx, cx, cy);
      const { pose, rmsPx } = tracker.track(pictures.luma(picture), picture.width, picture.height);
      return pose && rmsPx !== undefined ? { pose, rmsPx } : null;
    });
    (tracker as BoardTracker | null)?.free();
  }

  private trackerOf(spec: BoardSpec): BoardTracker {
    const key = JSON.stringify(spec);
    if (this.board?.key !== key) {
      this.board?.tracker.free();
      this.board = { key, tracker: new this.loaded.core.BoardTracker(spec) };
    }
    return this.board.tracker;
  }

  private pictureOf({ picture }: Shot): ImageBitmap {
    const found = picture ?? this.frame;
    if (!found) throw new Error("The camera has not shown a picture yet.");
    if (found === this.frame) this.frame = null;
    return found;
  }

  private track(spec: BoardSpec | null, frame: ImageBitmap): Tracked {
    const { core } = this.loaded;
    this.frame?.close();
    this.frame = frame;
    const { width, height } = frame;
    const picture = pictures.pixelsOf(frame, TRACK_SIDE);
    const grey = pictures.luma(picture);
    const quality = core.frameQuality(grey, picture.width, picture.height);
    const nothing: Tracked = {
      width, height, corners: [], pose: null, rmsPx: null, isAmbiguous: false, lens: null, lensSource: "assumed", quality,
    };
    if (spec === null) return nothing;
    const found = this.trackerOf(spec).track(grey, picture.width, picture.height);
    const grow = width / picture.width;
    const { focalPx, cx, cy } = found;
    return {
      ...nothing,
      corners: found.tags.map(({ corners }) => corners.map((value) => value * grow)),
      pose: found.pose ?? null,
      rmsPx: found.rmsPx ?? null,
      isAmbiguous: found.isAmbiguous ?? false,
      lens: { width, height, fx: focalPx * grow, fy: focalPx * grow, cx: cx * grow, cy: cy * grow },
      lensSource: found.intrinsicsSource,
    };
  }
}

/** Code and sentence of whatever was thrown. */
export function described(error: unknown): { code: string; message: string } {
  if (!(error instanceof Error)) return { code: "internal", message: String(error) };
  const code = "code" in error && typeof error.code === "string" ? error.code : "refused";
  return { code, message: error.message };
}
