// A capture: the planner's session, the photos in the store, and the record that binds them. No
// worker and no page in here, so that tests can call it.

import type { Scores } from "../core.js";
import { type Lens, resized } from "../geometry.js";
import { DISTANCE, toPlan } from "../layout.js";
import type { CaptureView, Faces, Kept, Progress, Rival, Setup, Shot } from "../messages.js";
import { type CaptureRecord, FORMAT, type PhotoRecord, VERSION } from "../record.js";
import { WINDOW, cut } from "../window.js";
import { Ledgers, rivals } from "./curves.js";
import { Journal } from "./journal.js";
import * as pictures from "./pictures.js";
import { pack, seen } from "./points.js";
import { StorageFull, type Store } from "./store.js";
import type { Model, Photo, Session, Vantage } from "./vantage.js";

/** Points that each rendered photo adds to the export. */
const POINTS_PER_PHOTO = 150;
/** Kept free beyond the photos themselves, bytes. */
const RESERVE = 256 * 1024;
/** A focal length that is off by more moves the camera by more than the board's own error. */
const FOCAL_TOLERANCE = 0.002;
/** What no photos are worth. */
const NONE: Scores = { coverage: 0, geometry: 0, diversity: 0, texture: 0 };

export class Capture {
  private ledgers: Ledgers | null = null;
  private triangles: Float32Array | null = null;
  private candidates: Float32Array;

  private constructor(
    private core: Vantage,
    private model: Model,
    readonly store: Store,
    private journal: Journal,
    readonly record: CaptureRecord,
    private session: Session,
  ) {
    const pool = new core.Pool(record.pool.space, record.pool.count, DISTANCE);
    this.candidates = pool.poses();
    pool.free();
  }

  static async start(core: Vantage, model: Model, store: Store, setup: Setup): Promise<Capture> {
    const { name, subject, layout, lens, pool, plan } = setup;
    const record: CaptureRecord = {
      format: FORMAT, version: VERSION, name, startedAt: new Date().toISOString(),
      subject, layout, lens, pool, plan, nextNumber: 1, photos: [],
    };
    // Refused plans are refused here, before what was kept is removed.
    const session = fresh(core, model, record);
    await store.clear();
    const capture = new Capture(core, model, store, new Journal(store), record, session);
    if (setup.file) await store.put("subject", new Uint8Array(await setup.file.arrayBuffer()));
    await capture.save();
    return capture;
  }

  /** What was kept from last time; null where there is nothing. */
  static async kept(store: Store): Promise<Kept | null> {
    const entry = await new Journal(store).read();
    if (!entry || entry.record.photos.length === 0) return null;
    const { name, photos, startedAt, subject } = entry.record;
    return { name, photos: photos.length, startedAt, subject };
  }

  static async resume(core: Vantage, model: Model, store: Store): Promise<Capture> {
    const journal = new Journal(store);
    const entry = await journal.read();
    if (!entry) throw new Error("There is no capture to go on with.");
    const { record, snapshot } = entry;
    let session: Session;
    try {
      session = core.Session.restore(snapshot, model);
    } catch {
      // Another version's snapshot: the photos tell the same story once more.
      session = await replayed(core, model, store, record);
    }
    return new Capture(core, model, store, journal, record, session);
  }

  /** The capture of an export that was read back: its files are in the store already. */
  static async adopt(core: Vantage, model: Model, store: Store, record: CaptureRecord): Promise<Capture> {
    const session = await replayed(core, model, store, record);
    const capture = new Capture(core, model, store, new Journal(store), record, session);
    await capture.save();
    return capture;
  }

  /** The object's triangles: from now on the curves are drawn. */
  setMesh(triangles: Float32Array): void {
    this.triangles = triangles;
    this.resetLedgers();
  }

  /** The faces of a photo taken before a reload, in the order of the photos. */
  addFaces(number: number, faces: Faces): void {
    const photo = this.photo(number);
    this.ledgers?.add(toPlan(this.record.layout, photo.pose), faces);
  }

  async shoot(shot: Shot, picture: ImageBitmap): Promise<void> {
    const { record, session, store } = this;
    const { faces, format } = shot;
    const lens = shot.lens ?? record.lens;
    const { width, height } = record.lens;
    // Trainers take one camera for the whole folder.
    if (record.photos.length > 0 && (picture.width !== width || picture.height !== height)) {
      throw new Error(
        `The photo was not kept: it is ${picture.width} × ${picture.height} where the others are ${width} × ${height}. ` +
          "Hold the camera upright or sideways as before.",
      );
    }
    const small = pictures.pixelsOf(picture);
    const window = cut(small, resized(lens, small.width, small.height), shot.pose, record.layout);
    const encoded = await pictures.encode(picture, format);
    picture.close();

    const number = record.nextNumber;
    const file = `frame_${String(number).padStart(5, "0")}.${format}`;
    await this.requireRoom(encoded.length);
    await store.put(file, encoded);
    await store.put(`${file}.window`, window.rgb);
    if (faces && this.triangles) {
      const side = Math.round(Math.sqrt(faces.planner.length));
      const points = seen(shot.pose, resized(lens, side, side), faces.planner, this.triangles, small, POINTS_PER_PHOTO);
      await store.put(`${file}.points`, pack(points));
    }

    // The photo is safe; only now does the plan go on.
    const next = session.nextView();
    const before = session.progress().scores ?? NONE;
    observe(session, shot.candidate, toPlan(record.layout, shot.pose), windowPhoto(window.rgb));
    const scores = session.progress().scores ?? NONE;
    const quality = this.core.frameQuality(pictures.luma(small), small.width, small.height);
    record.photos.push({
      number, file, bytes: encoded.length, takenAt: new Date().toISOString(),
      candidate: shot.candidate, pose: [...shot.pose], source: shot.source, focalPx: lens.fx,
      ...(shot.rmsPx === undefined ? {} : { rmsPx: shot.rmsPx }),
      quality, scores, gain: difference(scores, before),
      reason: next && next.index === shot.candidate ? next.reason : null,
    });
    record.nextNumber += 1;
    record.lens = lens;
    if (faces) this.ledgers?.add(toPlan(record.layout, shot.pose), faces);
    await this.save();
  }

  async skip(candidate: number): Promise<void> {
    this.session.skip(candidate);
    await this.save();
  }

  async block(candidate: number): Promise<void> {
    this.session.block(candidate);
    await this.save();
  }

  /** So many views more, whether or not the rest promises enough. */
  async more(views: number): Promise<void> {
    const { record } = this;
    const { stop: _, ...plan } = record.plan;
    const budget = Math.min(record.pool.count, Math.max(plan.budget, record.photos.length) + views);
    record.plan = { ...plan, budget };
    this.session.replan(record.plan);
    await this.save();
  }

  /** Deletes a photo; the plan is made anew from the others. */
  async delete(number: number): Promise<void> {
    const { record, store } = this;
    const photo = this.photo(number);
    record.photos = record.photos.filter((other) => other !== photo);
    this.session.free();
    this.session = await replayed(this.core, this.model, store, record);
    await this.save();
    // The record no longer names it: now the files can go.
    for (const name of [photo.file, `${photo.file}.window`, `${photo.file}.points`]) await store.remove(name);
    this.resetLedgers();
  }

  /** Finds the poses anew of photos that were taken before the lens was known as it is now. */
  async refine(poseOf: (photo: Blob, lens: Lens) => Promise<{ pose: Float32Array; rmsPx: number } | null>): Promise<void> {
    const { photos, lens } = this.record;
    const isStale = (photo: PhotoRecord): boolean =>
      photo.source === "board" && Math.abs(photo.focalPx / lens.fx - 1) > FOCAL_TOLERANCE;
    const stale = photos.filter(isStale);
    for (const photo of stale) {
      const found = await poseOf(await this.photoFile(photo.number), lens);
      if (found) Object.assign(photo, { pose: [...found.pose], rmsPx: found.rmsPx, focalPx: lens.fx });
    }
    if (stale.length > 0) await this.save();
  }

  /** The photos' numbers, so ordered that the first n are the n that the planner would take first. */
  async best(): Promise<number[]> {
    const { core, model, record, store } = this;
    const poses = record.photos.map((photo) => toPlan(record.layout, photo.pose));
    if (poses.length < 2) return record.photos.map((photo) => photo.number);
    const pool = core.Pool.fromPoses(Float32Array.from(poses.flatMap((pose) => [...pose])));
    const session = new core.Session(pool, { scheme: "support", budget: poses.length }, model);
    pool.free();
    const order: number[] = [];
    for (let next = session.nextView(); next; next = session.nextView()) {
      const photo = record.photos[next.index];
      if (!photo) break;
      order.push(photo.number);
      session.observe(next.index, await windowOf(store, photo));
    }
    session.free();
    return order;
  }

  async view(): Promise<CaptureView> {
    const { session, record } = this;
    return {
      record: structuredClone(record),
      candidates: this.candidates.slice(),
      statuses: session.statuses(),
      next: session.nextView() ?? null,
      finish: session.finish() ?? null,
      progress: progress(session),
      curves: this.ledgers ? structuredClone(this.ledgers.curves) : null,
      rivalPoses: this.rivalPoses(),
      room: await this.room(),
    };
  }

  photo(number: number): PhotoRecord {
    const found = this.record.photos.find((photo) => photo.number === number);
    if (!found) throw new Error(`There is no photo ${number}.`);
    return found;
  }

  async photoFile(number: number): Promise<Blob> {
    const { file } = this.photo(number);
    const blob = await this.store.get(file);
    if (!blob) throw new Error(`The file of photo ${number} is no longer in the browser's storage.`);
    return blob;
  }

  free(): void {
    this.session.free();
    this.ledgers?.free();
  }

  private async save(): Promise<void> {
    await this.journal.write({ record: this.record, snapshot: this.session.snapshot() });
  }

  private cachedRivals: Record<Rival, Float32Array> | null = null;
  private rivalPoses(): Record<Rival, Float32Array> | null {
    if (this.record.subject.kind === "camera") return null;
    this.cachedRivals ??= rivals(this.core, this.record);
    return this.cachedRivals;
  }

  private resetLedgers(): void {
    this.ledgers?.free();
    const poses = this.rivalPoses();
    this.ledgers = this.triangles && poses ? new Ledgers(this.core, this.triangles, poses) : null;
  }

  private async requireRoom(bytes: number): Promise<void> {
    const free = await freeBytes();
    if (this.store.kind !== "memory" && free !== null && free < bytes + RESERVE) throw new StorageFull();
  }

  private async room(): Promise<number | null> {
    const free = this.store.kind === "memory" ? null : await freeBytes();
    const { photos } = this.record;
    if (free === null || photos.length === 0) return null;
    const typical = photos.reduce((sum, photo) => sum + photo.bytes, 0) / photos.length + WINDOW * WINDOW * 3;
    return Math.max(0, Math.floor((free - RESERVE) / typical));
  }
}

async function freeBytes(): Promise<number | null> {
  const estimate = await globalThis.navigator?.storage?.estimate?.();
  return estimate?.quota === undefined ? null : estimate.quota - (estimate.usage ?? 0);
}

function fresh(core: Vantage, model: Model, record: CaptureRecord): Session {
  const pool = new core.Pool(record.pool.space, record.pool.count, DISTANCE);
  try {
    return new core.Session(pool, record.plan, model);
  } finally {
    pool.free();
  }
}

/** A session that has seen the record's photos, from their windows. */
async function replayed(core: Vantage, model: Model, store: Store, record: CaptureRecord): Promise<Session> {
  const session = fresh(core, model, record);
  for (const photo of record.photos) {
    observe(session, photo.candidate, toPlan(record.layout, photo.pose), await windowOf(store, photo));
  }
  return session;
}

const windowPhoto = (rgb: Uint8Array): Photo => ({ pixels: rgb, width: WINDOW, height: WINDOW, format: "rgb" });

function observe(session: Session, candidate: number | null, pose: Float32Array, photo: Photo): void {
  if (candidate === null) session.observeElsewhere(pose, photo);
  else session.observe(candidate, photo, pose);
}

async function windowOf(store: Store, photo: PhotoRecord): Promise<Photo> {
  const blob = await store.get(`${photo.file}.window`);
  if (!blob) throw new Error(`The file of photo ${photo.number} is no longer in the browser's storage.`);
  return windowPhoto(new Uint8Array(await blob.arrayBuffer()));
}

/** Null before the first photo. */
function progress(session: Session): Progress | null {
  const { scores, gainLeft, isEnough, clutter = 0 } = session.progress();
  return scores && gainLeft ? { scores, gainLeft, isEnough, clutter } : null;
}

function difference(a: Scores, b: Scores): Scores {
  return {
    coverage: a.coverage - b.coverage, geometry: a.geometry - b.geometry,
    diversity: a.diversity - b.diversity, texture: a.texture - b.texture,
  };
}
