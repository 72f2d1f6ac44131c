// examples/node over a capture that the command line made: VANTAGE_CAPTURE.

import { equal, match, ok } from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const capture = process.env.VANTAGE_CAPTURE;
const program = fileURLToPath(new URL("../../examples/node/plan.mjs", import.meta.url));

const run = (...words) => spawnSync(process.execPath, [program, ...words], { encoding: "utf8" });

test("the next views look at the object from where it was not photographed", () => {
  const { status, stdout, stderr } = run(capture, "--next", "3", "--json");
  equal(status, 0, stderr);
  const { photos, scores, gainLeft, next } = JSON.parse(stdout);
  equal(photos, JSON.parse(readFileSync(`${capture}/transforms.json`, "utf8")).frames.length);
  for (const objective of ["coverage", "geometry", "diversity", "texture"]) {
    ok(scores[objective] > 0 && scores[objective] < 1, `${objective} ${scores[objective]}`);
    ok(Number.isFinite(gainLeft[objective]));
  }
  equal(new Set(next.map(({ candidate }) => candidate)).size, 3);
  for (const { why, apartDeg, transform_matrix: matrix } of next) {
    match(why, /\w+ \w+/);
    ok(apartDeg > 5, `${apartDeg} degrees from a photo`);
    // The object stands at the origin and the cameras about 3 m away.
    const eye = matrix.slice(0, 3).map((row) => row[3]);
    ok(Math.abs(Math.hypot(...eye) - 3) < 0.2, `${eye}`);
    const towards = eye.map((value, row) => -value * -matrix[row][2]);
    const cosine = towards.reduce((sum, value) => sum + value) / Math.hypot(...eye);
    ok(cosine > 0.99, `cosine ${cosine}`);
  }
});

test("people are told in words", () => {
  const { status, stdout } = run(capture, "--next", "2");
  equal(status, 0);
  match(stdout, /coverage +[\d.]+ %/);
  match(stdout, / {2}2\. \d+° (above|below) the horizon, \d+° from \S+: .+ \(\+/);
});

test("bad input is one sentence", () => {
  for (const [words, status] of [[[], 2], [[capture, "--next", "0"], 2], [[capture, "--nxet", "2"], 2], [["/nowhere"], 1]]) {
    const ended = run(...words);
    equal(ended.status, status);
    match(ended.stderr, /^(usage|error): [^\n]+\n$/);
  }
});
