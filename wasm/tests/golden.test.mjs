// The package makes the plans of tests/same-plan, with numbers as bits.

import { deepEqual, equal } from "node:assert/strict";
import { test } from "node:test";

import { file, input, vantage } from "./package.mjs";

const { Model, Pool, Session } = vantage;

const lines = file("tests/same-plan/golden/plans.txt").toString().split("\n");

/** The indented lines under a heading of a section. */
function committed(section, heading) {
  const found = [];
  let at = lines.indexOf(heading, lines.indexOf(`[${section}]`)) + 1;
  while (lines[at]?.startsWith("  ")) found.push(lines[at++].trim());
  equal(found.length > 0, true, `${section}: ${heading}`);
  return found;
}

/** An f32 as its bits, 8 hexadecimal digits. */
function bits(value) {
  const view = new DataView(new ArrayBuffer(4));
  view.setFloat32(0, value);
  return view.getUint32(0).toString(16).padStart(8, "0");
}

const SPACES = {
  "random sphere": { kind: "random-sphere", seed: 7 },
  "fibonacci sphere": { kind: "fibonacci-sphere" },
  hemisphere: { kind: "hemisphere", minElevationRad: 0.1, maxElevationRad: 1.2 },
  rings: { kind: "rings", rings: 3, minElevationRad: -0.2, maxElevationRad: 0.9 },
  spiral: { kind: "spiral", turns: 4, minElevationRad: 0, maxElevationRad: 1.5 },
};

for (const [name, space] of Object.entries(SPACES)) {
  test(`candidates: ${name}`, () => {
    const poses = new Pool(space, 12, 1.5).poses();
    const written = Array.from({ length: 12 }, (_, index) => {
      const place = [3, 7, 11].map((column) => bits(poses[12 * index + column]));
      return `${index} ${place.join(" ")}`;
    });
    deepEqual(written, committed("candidates", name));
  });
}

const POSE_PLANS = {
  random: { scheme: "random", budget: 10, seed: 5 },
  "farthest point": { scheme: "farthest-point", budget: 10, seed: 5 },
  "pseudo-coverage": { scheme: "pseudo-coverage", budget: 10 },
  "farthest point, movement costs 0.8": { scheme: "farthest-point", budget: 10, movementCost: 0.8 },
};

for (const [name, plan] of Object.entries(POSE_PLANS)) {
  for (const [spaceName, space] of Object.entries(SPACES)) {
    test(`plans by poses: ${name}, ${spaceName}`, () => {
      const session = new Session(new Pool(space, 48, 1.5), plan);
      const written = [];
      // The third view is blocked, the fifth skipped once.
      for (let next, asked = 1; (next = session.nextView()); asked++) {
        const act = { 3: "block", 5: "skip" }[asked];
        session[act ?? "observe"](next.index);
        const mark = { block: " blocked", skip: " skipped" }[act] ?? "";
        written.push(`${next.index} ${bits(next.gain)}${mark}`);
      }
      written.push(session.finish().replace("-", " "));
      const left = session.statuses().flatMap((status, index) => (status === "available" ? [index] : []));
      const { order, lengthRad } = session.tour(Uint32Array.from(left.slice(0, 12)));
      written.push(`tour ${bits(lengthRad)} ${order.join(" ")}`);
      deepEqual(written, committed("plans by poses", `${name}, ${spaceName}`));
    });
  }
}

const [WIDTH, HEIGHT] = [90, 70];
const BYTES = 3 * WIDTH * HEIGHT;
const CENTRE = [0.05, -0.1, 0.02];
const LETTERS = { coverage: "C", geometry: "Q", diversity: "D", texture: "T" };

const NETWORK_PLANS = {
  ensemble: [{ scheme: "ensemble", budget: 10 }, "with-images"],
  "ensemble without images": [{ scheme: "ensemble", budget: 10 }, "without-images"],
  sum: [{ scheme: "sum", budget: 10 }, "with-images"],
  support: [{ scheme: "support", budget: 10 }, "with-images"],
  "support without images: farthest": [{ scheme: "support", budget: 10 }, "without-images"],
  "diversity, movement costs 0.3": [
    { scheme: "diversity", budget: 10, movementCost: 0.3 },
    "with-images",
  ],
};

/** FNV-1a, as the text has it. */
function digest(bytes) {
  const hash = bytes.reduce((hash, byte) => Math.imul(hash ^ byte, 0x01000193), 0x811c9dc5);
  return (hash >>> 0).toString(16).padStart(8, "0");
}

/** A picture with each colour in `channels` bytes. */
function photo(rgb, format) {
  const channels = format === "rgba" ? 4 : 3;
  const pixels = new Uint8ClampedArray(channels * WIDTH * HEIGHT).fill(7);
  rgb.forEach((value, at) => (pixels[channels * Math.floor(at / 3) + (at % 3)] = value));
  return { pixels, width: WIDTH, height: HEIGHT, format };
}

for (const format of ["rgb", "rgba"]) {
  for (const [name, [plan, network]] of Object.entries(NETWORK_PLANS)) {
    test(`plans by a network: ${name}, photos as ${format}`, () => {
      const model = new Model(input(`${network}.model`));
      const pictures = input("pictures.rgb");
      // The candidates look at the origin; the network and the plan are told of another centre.
      const pool = new Pool({ kind: "fibonacci-sphere" }, 40, 1.5);
      let session = new Session(pool, { ...plan, centre: CENTRE }, model);
      const written = [];
      while (session.nextView()) {
        const { index, objective, gain } = session.nextView();
        const picture = pictures.subarray(BYTES * index, BYTES * (index + 1));
        session.observe(index, photo(picture, format));
        // Before `progress` looks for the next view, which a snapshot tells of.
        const kept = session.snapshot();
        const { scores } = session.progress();
        const numbers = [gain, ...Object.keys(LETTERS).map((objective) => scores[objective])];
        written.push(`${index} ${LETTERS[objective] ?? "-"} ${numbers.map(bits).join(" ")}`);
        if (written.length === 5) {
          written.push(`snapshot: ${kept.length} bytes, ${digest(kept)}`);
          session.free();
          session = Session.restore(kept, model);
        }
      }
      deepEqual(written, committed("plans by a network", name));
    });
  }
}
