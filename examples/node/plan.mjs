// Names the next views of a capture: node plan.mjs FOLDER [--next K] [--json]
//
// FOLDER holds transforms.json, as nerfstudio, Polycam, Record3D and instant-ngp write it, and the
// photos that it names.

import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { basename, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

import sharp from "sharp";
import { load } from "vantage-wasm";

import {
  add, angle, degrees, elevation, layoutOf, length, levelling, lookingAtOrigin, median, position, scale,
  subtract, windowOf,
} from "./layout.mjs";

const RADIUS = 3; // of the plan's sphere of views; the object's is 1
const APART_RAD = 0.52; // between the views that are named
const MARGIN_RAD = 0.26; // above and below what was reached

/** The frames of transforms.json: file, matrix, and the lens in pixels. */
async function readFrames(folder) {
  const file = join(folder, "transforms.json");
  if (!existsSync(file)) throw new Error(`there is no ${file}: name the folder of a capture`);
  const top = JSON.parse(await readFile(file, "utf8"));
  if (!Array.isArray(top.frames) || top.frames.length === 0) throw new Error("transforms.json has no frames");
  return top.frames.map((frame) => {
    const { file_path: named, transform_matrix: matrix } = frame;
    const known = { ...top, ...frame };
    const file = [named, `${named}.png`, `${named}.jpg`].map((name) => join(folder, name)).find(existsSync);
    if (matrix?.length < 3 || !matrix.flat().every(Number.isFinite)) throw new Error(`${named} has no pose`);
    return { named, file, matrix, known };
  });
}

/** The picture in rgb, on grey where it is transparent, and the lens that took it. */
async function decode({ file, known }) {
  const { data, info } = await sharp(file)
    .toColourspace("srgb").flatten({ background: { r: 128, g: 128, b: 128 } }).removeAlpha()
    .raw().toBuffer({ resolveWithObject: true });
  const { width, height } = info;
  // The intrinsics may be those of a larger or smaller copy.
  const grow = width / (known.w ?? width);
  const focal = known.fl_x ? known.fl_x * grow : width / (2 * Math.tan(known.camera_angle_x / 2));
  if (!(focal > 0)) throw new Error("transforms.json gives no focal length: fl_x or camera_angle_x");
  const lens = { width, height, focal, cx: (known.cx ?? known.w / 2) * grow || width / 2, cy: (known.cy ?? known.h / 2) * grow || height / 2 };
  return { lens, photo: { pixels: data, width, height, format: "rgb" } };
}

/** The session with all photos taken in, and how to get back to the file's coordinates. */
async function begin(vantage, folder, say) {
  const frames = [];
  for (const frame of await readFrames(folder)) {
    if (frame.file) frames.push({ ...frame, ...(await decode(frame)) });
    else say(`${frame.named} is skipped: there is no such file`);
  }
  if (frames.length === 0) throw new Error("none of the photos is there");
  const layout = layoutOf(frames);
  const { level, restore } = levelling(layout.up);
  const taken = frames.map((frame) => ({ ...frame, direction: level(subtract(position(frame.matrix), layout.centre)) }));
  const heights = taken.map(({ direction }) => elevation(direction));
  const limit = (angle) => Math.max(-1.4, Math.min(1.4, angle));

  const pool = new vantage.Pool(
    {
      kind: "hemisphere",
      minElevationRad: limit(Math.min(...heights) - MARGIN_RAD),
      maxElevationRad: limit(Math.max(...heights) + MARGIN_RAD),
    },
    Math.max(100, 2 * taken.length),
    RADIUS,
  );
  const model = new vantage.Model(await readFile(fileURLToPath(import.meta.resolve("vantage-wasm/soarnet.model"))));
  const session = new vantage.Session(pool, { scheme: "support", budget: pool.length }, model);
  for (const { named, matrix, lens, photo, direction } of taken) {
    const window = windowOf({ matrix, lens }, layout);
    const pose = lookingAtOrigin(scale(direction, RADIUS / length(direction)));
    if (window) session.observeElsewhere(pose, { ...photo, window });
    else say(`${named} is skipped: it looks away from the object`);
  }
  const distance = median(taken.map(({ direction }) => length(direction)));
  /** A pose of the plan, 12 numbers, as a matrix of the file, shape (4, 4). */
  const inFile = (pose) => {
    const columns = [0, 1, 2].map((axis) => restore([pose[axis], pose[4 + axis], pose[8 + axis]]));
    const eye = add(layout.centre, scale(restore([pose[3], pose[7], pose[11]]), distance / RADIUS));
    return [...[0, 1, 2].map((row) => [...columns.map((column) => column[row]), eye[row]]), [0, 0, 0, 1]];
  };
  return { session, taken, inFile };
}

/** The next view, then the best that lie well apart from those before. */
function nextViews({ session, taken, inFile }, count) {
  const poses = session.poses();
  const direction = (index) => [3, 7, 11].map((at) => poses[12 * index + at]);
  const views = [];
  for (let next; views.length < count && (next = session.nextView()); ) {
    const towards = direction(next.index);
    const nearest = taken.toSorted((a, b) => angle(a.direction, towards) - angle(b.direction, towards))[0];
    views.push({
      candidate: next.index,
      why: next.why,
      objective: next.objective,
      gain: next.gain,
      elevationDeg: degrees(elevation(towards)),
      nearestPhoto: nearest.named,
      apartDeg: degrees(angle(nearest.direction, towards)),
      transform_matrix: inFile(next.pose),
    });
    session.statuses().forEach((status, index) => {
      if (status === "available" && angle(direction(index), towards) < APART_RAD) session.skip(index);
    });
  }
  return views;
}

/** The folder and the number of views from the command line; undefined where it says something else. */
function read(args) {
  const options = { next: { type: "string", default: "5" }, json: { type: "boolean", default: false } };
  try {
    const { values, positionals } = parseArgs({ args, allowPositionals: true, options });
    const count = Number(values.next);
    if (positionals.length === 1 && Number.isInteger(count) && count >= 1) return { folder: positionals[0], count, isJson: values.json };
  } catch {
    // Node's words for an unknown option go on about quoting; the usage says it.
  }
}

const asked = read(process.argv.slice(2));
if (!asked) {
  console.error("usage: node plan.mjs FOLDER [--next K] [--json]");
  process.exit(2);
}
const { folder, count, isJson } = asked;
try {
  const capture = await begin(await load(), folder, (line) => console.error(`warning: ${line}`));
  const { scores, gainLeft } = capture.session.progress();
  const views = nextViews(capture, count);
  if (isJson) {
    console.log(JSON.stringify({ photos: capture.taken.length, scores, gainLeft, next: views }, null, 2));
  } else {
    const share = (value) => `${(100 * value).toFixed(1)} %`;
    console.log(`${capture.taken.length} photos. Estimated so far, and what one more may add:`);
    for (const [objective, score] of Object.entries(scores)) {
      console.log(`  ${objective.padEnd(9)} ${share(score).padStart(7)}  +${share(gainLeft[objective])}`);
    }
    console.log("Next views:");
    views.forEach((view, index) => {
      console.log(
        `  ${index + 1}. ${Math.abs(view.elevationDeg).toFixed(0)}° ${view.elevationDeg < 0 ? "below" : "above"} the horizon, ` +
          `${view.apartDeg.toFixed(0)}° from ${basename(view.nearestPhoto)}: ${view.why} (+${share(view.gain)})`,
      );
    });
  }
} catch (error) {
  console.error(`error: ${error.message}`);
  process.exit(1);
}
