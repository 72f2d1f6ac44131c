// A capture taken elsewhere, or saved here before: what it lacks, and what to photograph next.

import type { Objective } from "../core.js";
import { type Vec3, angleBetween, position, radians } from "../geometry.js";
import { DISTANCE, LayoutError, directionOf, estimate, fromPlan, toPlan } from "../layout.js";
import type { ImportReport, Named, Reshoot } from "../messages.js";
import { checkRecord, type CaptureRecord } from "../record.js";
import { OBJECTIVES, clutterWords, direction, way } from "../words.js";
import { WINDOW, cut } from "../window.js";
import { type Foreign, ForeignError, parsePolycam, parseRecord3d, parseTransforms } from "./foreign.js";
import * as pictures from "./pictures.js";
import type { Model, Session, Vantage } from "./vantage.js";
import * as zip from "./zip.js";

/** A photo of which less than this share of the window shows anything hardly shows the object. */
const LEAST_SHARE = 0.25;
/** The views named lie so far from each other, where there are such views. */
const APART_RAD = radians(30);
/** Views named. */
const RESHOOT = 6;
/** A photo that would add less to each score is not worth taking: the core's own rule. */
const WORTH = 0.005;
/** The network remembers no more photos. */
const MOST_VIEWS = 256;
/** Beyond the elevations that the photos reach, so much more is thought within reach. */
const MARGIN_RAD = radians(15);

type Entry = { path: string; size: number; read: () => Promise<Uint8Array> };

export type Imported = { report: ImportReport; record: CaptureRecord | null; entries: Entry[] };

/** Reads a zip or a folder's files and plans from them. */
export async function importCapture(core: Vantage, model: Model, files: readonly Named[]): Promise<Imported> {
  const entries = await listed(files);
  const { foreign, root } = await manifest(entries);
  const lookup = new Map(entries.map((entry) => [entry.path, entry]));
  const skipped: ImportReport["skipped"] = [];
  const usable: { name: string; pose: Float32Array; lens: ReturnType<Foreign["frames"][number]["lens"]>; pixels: ReturnType<typeof pictures.pixelsOf> }[] = [];
  for (const frame of foreign.frames) {
    try {
      const entry = frame.paths.map((path) => lookup.get(root + path)).find((found) => found !== undefined);
      if (!entry) throw new Error("there is no such file");
      const bytes = await entry.read().catch(() => {
        throw new Error("it is damaged: its checksum does not match");
      });
      const bitmap = await pictures.decode(new Blob([bytes as Uint8Array<ArrayBuffer>]));
      const lens = frame.lens(bitmap.width, bitmap.height);
      const pixels = pictures.pixelsOf(bitmap, 512);
      bitmap.close();
      const [x, y] = [pixels.width / lens.width, pixels.height / lens.height];
      const small = { width: pixels.width, height: pixels.height, fx: lens.fx * x, fy: lens.fy * y, cx: lens.cx * x, cy: lens.cy * y };
      usable.push({ name: frame.name, pose: frame.pose, lens: small, pixels });
    } catch (error) {
      skipped.push({ path: frame.name, why: error instanceof Error ? error.message : String(error) });
    }
  }
  if (usable.length === 0) {
    throw new ForeignError(`None of the ${foreign.frames.length} photos can be used; the first, ${skipped[0]?.path ?? ""}: ${skipped[0]?.why ?? ""}.`);
  }
  const layout = estimate(usable, foreign.keepsZUp);
  const photos: ImportReport["photos"] = [];
  const windows: { pose: Float32Array; rgb: Uint8Array }[] = [];
  for (const { name, pose, lens, pixels } of usable) {
    const { rgb, share } = cut(pixels, lens, pose, layout);
    if (share < LEAST_SHARE) {
      skipped.push({ path: name, why: `it hardly shows the object: ${Math.round(100 * share)} % of it` });
      continue;
    }
    photos.push({ path: name, pose });
    windows.push({ pose: toPlan(layout, pose), rgb });
  }
  if (windows.length === 0) throw new ForeignError("No photo shows the object that the cameras look at.");

  const session = sessionOver(core, model, windows.map(({ pose }) => pose));
  try {
    for (const { pose, rgb } of spread(windows)) {
      session.observeElsewhere(pose, { pixels: rgb, width: WINDOW, height: WINDOW, format: "rgb" });
    }
    const { scores = null, gainLeft = null, clutter = 0 } = session.progress();
    const isEnough = gainLeft !== null && Object.values(gainLeft).every((gain) => gain < WORTH);
    const reshoot = reshootList(session, photos, layout);
    const record = await ours(entries, root);
    const notes = [...foreign.notes];
    if (windows.length > MOST_VIEWS) notes.push(`The network remembers ${MOST_VIEWS} photos: those farthest from each other are used.`);
    const cluttered = clutterWords(clutter);
    if (cluttered) notes.push(cluttered);
    return {
      report: {
        name: nameOf(files, root), origin: record ? "this page" : foreign.origin, photos, skipped, notes, layout,
        scores, gainLeft, isEnough, reshoot, canResume: record !== null,
      },
      record, entries: entries.map((entry) => ({ ...entry, path: entry.path.slice(root.length) })),
    };
  } finally {
    session.free();
  }
}

/** Whether an error is a sentence meant for people. */
export const isPlain = (error: unknown): boolean => error instanceof ForeignError || error instanceof LayoutError;

async function listed(files: readonly Named[]): Promise<Entry[]> {
  const [only] = files;
  if (files.length === 1 && only && /\.zip$/i.test(only.path)) {
    try {
      return (await zip.open(only.file)).filter(({ path }) => !path.startsWith("__MACOSX/"));
    } catch {
      throw new ForeignError(`${only.path} cannot be opened: it is damaged or not a zip. Download or copy it again.`);
    }
  }
  return files.map(({ path, file }) => ({
    path, size: file.size, read: async () => new Uint8Array(await file.arrayBuffer()),
  }));
}

/** The description of the poses, and the folder it lies in. */
async function manifest(entries: readonly Entry[]): Promise<{ foreign: Foreign; root: string }> {
  const find = (name: string): Entry | undefined =>
    entries.filter(({ path }) => path === name || path.endsWith(`/${name}`)).sort((a, b) => a.path.length - b.path.length)[0];
  const rootOf = (entry: Entry, name: string): string => entry.path.slice(0, entry.path.length - name.length);
  for (const [name, parse] of [["transforms.json", parseTransforms], ["metadata.json", parseRecord3d]] as const) {
    const entry = find(name);
    if (entry) return { foreign: parse(await json(entry)), root: rootOf(entry, name) };
  }
  const pattern = /^(.*?)keyframes\/(corrected_)?cameras\/[^/]+\.json$/;
  const cameras = entries.filter(({ path }) => pattern.test(path));
  const corrected = cameras.filter(({ path }) => path.includes("corrected_cameras"));
  const chosen = corrected.length > 0 ? corrected : cameras;
  const [first] = chosen;
  if (first) {
    const contents = await Promise.all(chosen.map(async (entry) => ({ path: entry.path, content: await json(entry) })));
    return { foreign: parsePolycam(contents), root: pattern.exec(first.path)?.[1] ?? "" };
  }
  throw new ForeignError(
    "There is no transforms.json in it. Choose the folder or zip that nerfstudio, Polycam, Record3D, NeRFCapture or this page wrote.",
  );
}

async function json(entry: Entry): Promise<Record<string, unknown>> {
  try {
    return JSON.parse(new TextDecoder().decode(await entry.read())) as Record<string, unknown>;
  } catch {
    throw new ForeignError(`${entry.path} is damaged: it cannot be read as JSON.`);
  }
}

/** The record that this page wrote, if it did and the capture can be gone on with. */
async function ours(entries: readonly Entry[], root: string): Promise<CaptureRecord | null> {
  const entry = entries.find(({ path }) => path === `${root}capture.json`);
  if (!entry) return null;
  try {
    const record = checkRecord(await json(entry));
    return record.subject.kind === "file" ? null : record;
  } catch {
    return null;
  }
}

function nameOf(files: readonly Named[], root: string): string {
  const folder = root.replace(/\/$/, "");
  return folder !== "" ? folder.slice(folder.lastIndexOf("/") + 1) : (files[0]?.path ?? "capture").replace(/\.zip$/i, "");
}

function sessionOver(core: Vantage, model: Model, poses: readonly Float32Array[]): Session {
  const rises = poses.map((pose) => {
    const [x, y, z] = position(pose);
    return Math.atan2(z, Math.hypot(x, y));
  });
  const steepest = radians(85);
  const pool = new core.Pool(
    {
      kind: "hemisphere",
      minElevationRad: Math.max(-steepest, Math.min(...rises) - MARGIN_RAD),
      maxElevationRad: Math.min(steepest, Math.max(...rises) + MARGIN_RAD),
    },
    Math.min(400, Math.max(100, 2 * poses.length)),
    DISTANCE,
  );
  try {
    const views = Math.min(poses.length, MOST_VIEWS);
    return new core.Session(pool, { scheme: "support", budget: Math.min(pool.length, views + 1) }, model);
  } finally {
    pool.free();
  }
}

/** What a view serves best: the objective in which it comes nearest to the best view. */
function reasons(session: Session): (index: number) => Objective {
  const gains = OBJECTIVES.map(({ name }) => {
    const all = session.gains(name);
    const most = all.reduce((best, gain) => (gain > best ? gain : best), 0);
    return { name, shares: all.map((gain) => (most > 0 ? gain / most : 0)) };
  });
  return (index) => {
    const share = ({ shares }: (typeof gains)[number]): number => shares[index] ?? 0;
    return gains.reduce((best, other) => (share(other) > share(best) ? other : best)).name;
  };
}

/** As many photos as the network remembers: all, or those farthest from each other. */
function spread<T extends { pose: Float32Array }>(photos: readonly T[]): T[] {
  if (photos.length <= MOST_VIEWS) return [...photos];
  const nearest = photos.map(() => Number.POSITIVE_INFINITY);
  const kept = new Set<number>();
  while (kept.size < MOST_VIEWS) {
    const next = nearest.indexOf(Math.max(...nearest));
    const from = photos[next];
    if (!from) break;
    kept.add(next);
    photos.forEach((photo, index) => {
      const apart = angleBetween(position(photo.pose), position(from.pose));
      nearest[index] = Math.min(nearest[index] ?? 0, kept.has(index) ? -1 : apart);
    });
  }
  return photos.filter((_, index) => kept.has(index));
}

/** The next view, then others that lie well apart, in case it cannot be reached. */
function reshootList(session: Session, photos: ImportReport["photos"], layout: ImportReport["layout"]): Reshoot[] {
  const list: Reshoot[] = [];
  const places = session.poses();
  const reasonFor = reasons(session);
  for (let next = session.nextView(); next && list.length < RESHOOT; next = session.nextView()) {
    const out: Vec3 = position(next.pose);
    const apart = photos.map(({ pose }) => angleBetween(directionOf(layout, position(pose)), out));
    const nearest = photos[apart.indexOf(Math.min(...apart))];
    const place = nearest
      ? { nearest: nearest.path, way: way(directionOf(layout, position(nearest.pose)), out) }
      : { nearest: "", way: `${Math.round(direction(out).elevationDeg)}° above the horizon` };
    list.push({ pose: fromPlan(layout, next.pose), planPose: next.pose, reason: reasonFor(next.index), gain: next.gain, ...place });
    for (let index = 0; 12 * index < places.length; index += 1) {
      if (angleBetween(position(places, index), out) < APART_RAD) session.block(index);
    }
  }
  return list;
}
