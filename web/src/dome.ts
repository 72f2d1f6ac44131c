// The dome of candidate views as SVG: an orthographic picture from an adjustable side.

import type { Status } from "./messages.js";
import { type Camera, type State, position } from "./state.js";

export type Dot = {
  index: number;
  x: number; // to the right, in [-1, 1]
  y: number; // downwards, in [-1, 1]
  depth: number; // towards the viewer, in [-1, 1]
  mark: Status | "next";
};

/** The directions of the candidates, seen from the camera's side, the farthest first, the next last. */
export function dots(state: State): Dot[] {
  const { poses, progress, camera } = state;
  if (progress === null) return [];
  const found = progress.statuses.map((status, index): Dot => {
    const mark = progress.next?.index === index ? "next" : status;
    return { index, mark, ...project(unit(position(poses, index)), camera) };
  });
  const isNext = (dot: Dot): number => (dot.mark === "next" ? 1 : 0);
  return found.sort((a, b) => isNext(a) - isNext(b) || a.depth - b.depth || a.index - b.index);
}

type Point = { x: number; y: number; depth: number };

/** A point of the world, +Z up, on the picture plane. */
export function project([x, y, z]: [number, number, number], camera: Camera): Point {
  const [sa, ca] = [Math.sin(camera.azimuthRad), Math.cos(camera.azimuthRad)];
  const [se, ce] = [Math.sin(camera.elevationRad), Math.cos(camera.elevationRad)];
  const forward = x * ca + y * sa;
  return { x: y * ca - x * sa, y: -(z * ce - forward * se), depth: forward * ce + z * se };
}

function unit([x, y, z]: [number, number, number]): [number, number, number] {
  const length = Math.hypot(x, y, z) || 1;
  return [x / length, y / length, z / length];
}

const SVG = "http://www.w3.org/2000/svg";

/** Draws the dome anew. Selecting a view is left to `select`. */
export function draw(place: HTMLElement, state: State): void {
  const svg = element("svg", { viewBox: "-1.15 -1.15 2.3 2.3" });
  svg.append(element("circle", { class: "horizon", r: "1" }));
  svg.append(element("path", { class: "floor", d: ring(state.camera) }));
  svg.append(way(state));
  svg.append(element("rect", { class: "object", x: "-0.07", y: "-0.07", width: "0.14", height: "0.14" }));
  for (const dot of dots(state)) {
    const mark = dot.depth < 0 ? `${dot.mark} behind` : dot.mark;
    const at = { class: `dot ${mark}`, transform: `translate(${dot.x.toFixed(4)} ${dot.y.toFixed(4)})` };
    const sign =
      dot.mark === "blocked"
        ? element("path", { ...at, d: "M-.03-.03.03.03M.03-.03-.03.03" })
        : element("circle", { ...at, r: dot.mark === "next" ? "0.06" : "0.035" });
    sign.append(title(`view ${dot.index}: ${dot.mark}`));
    svg.append(sign);
  }
  place.replaceChildren(svg);
  place.setAttribute("aria-label", summary(state));
}

/** The horizon of the object as seen from the camera's side. */
function ring(camera: Camera): string {
  const points = Array.from({ length: 49 }, (_, step) => {
    const turn = (step / 48) * 2 * Math.PI;
    const { x, y } = project([Math.cos(turn), Math.sin(turn), 0], camera);
    return `${x.toFixed(3)} ${y.toFixed(3)}`;
  });
  return `M${points.join("L")}Z`;
}

/** The line through the views taken, to the next one. */
function way(state: State): SVGElement {
  const { progress, poses, camera } = state;
  const stops = progress === null ? [] : [...progress.views];
  if (progress?.next) stops.push(progress.next.index);
  const points = stops.map((index) => {
    const { x, y } = project(unit(position(poses, index)), camera);
    return `${x.toFixed(3)},${y.toFixed(3)}`;
  });
  return element("polyline", { class: "way", points: points.join(" ") });
}

function summary(state: State): string {
  const count = (mark: Dot["mark"]): number => dots(state).filter((dot) => dot.mark === mark).length;
  return (
    `${state.progress?.statuses.length ?? 0} views around the object: ${count("visited")} taken, ` +
    `${count("skipped")} skipped, ${count("blocked")} out of reach`
  );
}

function element(name: string, attributes: Record<string, string>): SVGElement {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

function title(text: string): SVGElement {
  const made = element("title", {});
  made.textContent = text;
  return made;
}
