// The dome of candidate views: an orthographic picture from an adjustable side.

import { type SVGTemplateResult, svg } from "lit-html";
import type { Status } from "./core.js";
import { type Vec3, position, unit } from "./geometry.js";
import type { DomeSide } from "./state.js";

export type Dot = { index: number; x: number; y: number; depth: number; mark: Status | "next" };

/** What the dome shows: directions from the object, in the planner's coordinates. */
export type DomeScene = {
  candidates: Float32Array;
  statuses: readonly Status[];
  next: number | null;
  /** Where photos were taken, in order. */
  way: readonly Vec3[];
  /** Whether their order means anything. */
  isOrdered: boolean;
  /** Where the camera is now; null where it is not known. */
  here: Vec3 | null;
};

/** Half the picture's width, where the dome's radius is 1. */
export const RIM = 1.12;

/** A direction on the picture plane: x to the right, y down, depth towards the viewer. */
export function onPlane([x, y, z]: Vec3, side: DomeSide): { x: number; y: number; depth: number } {
  const [sa, ca] = [Math.sin(side.azimuthRad), Math.cos(side.azimuthRad)];
  const [se, ce] = [Math.sin(side.elevationRad), Math.cos(side.elevationRad)];
  const forward = x * ca + y * sa;
  return { x: y * ca - x * sa, y: -(z * ce - forward * se), depth: forward * ce + z * se };
}

/** The candidates, the farthest first, the next view last. */
export function dots({ candidates, statuses, next }: DomeScene, side: DomeSide): Dot[] {
  const found = statuses.map((status, index): Dot => ({
    index, mark: next === index ? "next" : status, ...onPlane(unit(position(candidates, index)), side),
  }));
  const isNext = (dot: Dot): number => (dot.mark === "next" ? 1 : 0);
  return found.sort((a, b) => isNext(a) - isNext(b) || a.depth - b.depth || a.index - b.index);
}

/** In words, for those who do not see it. */
export function summary(scene: DomeScene): string {
  const count = (mark: Status): number => scene.statuses.filter((status) => status === mark).length;
  const parts = [`${scene.way.length} photos taken`, `${count("available")} places left`];
  if (count("skipped") > 0) parts.push(`${count("skipped")} put off`);
  if (count("blocked") > 0) parts.push(`${count("blocked")} out of reach`);
  return `Dome of camera places around the object: ${parts.join(", ")}`;
}

export function dome(scene: DomeScene, side: DomeSide): SVGTemplateResult {
  const half = RIM;
  return svg`<svg class="dome" viewBox="${-half} ${-half} ${2 * half} ${2 * half}" role="img" aria-label=${summary(scene)}>
    <path class="floor" d=${ring(side)} />
    <circle class="horizon" r="1" />
    ${scene.isOrdered ? svg`<polyline class="way" points=${line([...scene.way, ...nextPlace(scene)], side)} />` : null}
    ${dots(scene, side).map((dot) => sign(dot))}
    ${scene.way.map((place) => taken(place, side))}
    ${scene.here === null ? null : here(scene.here, side)}
  </svg>`;
}

function nextPlace({ candidates, next }: DomeScene): Vec3[] {
  return next === null ? [] : [unit(position(candidates, next))];
}

function sign({ x, y, depth, mark }: Dot): SVGTemplateResult | null {
  const place = `translate(${x.toFixed(3)} ${y.toFixed(3)})`;
  const name = `dot ${mark}${depth < 0 ? " behind" : ""}`;
  switch (mark) {
    case "next":
      return svg`<g class=${name} transform=${place}><circle class="halo" r="0.13" /><circle r="0.065" /></g>`;
    case "blocked":
      return svg`<path class=${name} transform=${place} d="M-.025-.025.025.025M.025-.025-.025.025" />`;
    case "visited":
      return null; // Drawn where the photo was really taken.
    case "available":
    case "skipped":
      return svg`<circle class=${name} transform=${place} r="0.022" />`;
  }
}

function taken(place: Vec3, side: DomeSide): SVGTemplateResult {
  const { x, y, depth } = onPlane(place, side);
  return svg`<circle class="dot visited ${depth < 0 ? "behind" : ""}" cx=${x.toFixed(3)} cy=${y.toFixed(3)} r="0.042" />`;
}

function here(place: Vec3, side: DomeSide): SVGTemplateResult {
  const { x, y } = onPlane(unit(place), side);
  return svg`<g class="here" transform="translate(${x.toFixed(3)} ${y.toFixed(3)})"><circle r="0.075" /><path d="M-.12 0H.12M0-.12V.12" /></g>`;
}

function ring(side: DomeSide): string {
  const places = Array.from({ length: 49 }, (_, step): Vec3 => {
    const turn = (step / 48) * 2 * Math.PI;
    return [Math.cos(turn), Math.sin(turn), 0];
  });
  return `M${line(places, side).replaceAll(" ", "L")}Z`;
}

function line(places: readonly Vec3[], side: DomeSide): string {
  return places
    .map((place) => onPlane(place, side))
    .map(({ x, y }) => `${x.toFixed(3)},${y.toFixed(3)}`)
    .join(" ");
}
