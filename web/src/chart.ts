// Small charts as SVG: the curves of a simulated capture, the bars of what is expected.

import { type SVGTemplateResult, type TemplateResult, html, svg } from "lit-html";
import type { Scores } from "./core.js";
import type { Curve, Curves, Rival } from "./messages.js";
import { OBJECTIVES, percent } from "./words.js";

const LANES: readonly { lane: Rival | "planner"; title: string }[] = [
  { lane: "planner", title: "Vantage" },
  { lane: "farthest", title: "Farthest point" },
  { lane: "rings", title: "Rings" },
  { lane: "random", title: "Random" },
];

const [WIDTH, HEIGHT, LEFT, BOTTOM] = [320, 150, 34, 20];

/** Exact scores against the number of photos, ours beside the rivals'. */
export function curves(all: Curves, key: keyof Curve, title: string, budget: number): TemplateResult {
  const x = (photo: number): number => LEFT + ((WIDTH - LEFT - 8) * photo) / Math.max(1, budget);
  // From the worst first photo up, so that the differences are seen; the axis says so.
  const values = LANES.flatMap(({ lane }) => all[lane][key]);
  const floor = Math.floor(10 * Math.min(0.8, ...values)) / 10;
  const ceiling = Math.min(1, Math.max(floor + 0.2, Math.ceil(10 * Math.max(...values, 0.1)) / 10));
  const y = (value: number): number => 6 + (HEIGHT - BOTTOM - 6) * (1 - (value - floor) / (ceiling - floor));
  const marks = [floor, (floor + ceiling) / 2, ceiling];
  const last = (lane: Rival | "planner"): string => {
    const value = all[lane][key].at(-1);
    return value === undefined ? "–" : percent(value);
  };
  return html`<figure class="chart">
    <figcaption>${title}</figcaption>
    <svg viewBox="0 0 ${WIDTH} ${HEIGHT}" role="img" aria-label=${`${title} after ${all.planner[key].length} photos: ${LANES.map(({ lane, title }) => `${title} ${last(lane)}`).join(", ")}`}>
      ${marks.map((mark) => svg`<path class="grid" d="M${LEFT} ${y(mark)}H${WIDTH - 8}" /><text class="tick" x=${LEFT - 5} y=${y(mark) + 3.5} text-anchor="end">${Math.round(100 * mark)}</text>`)}
      <text class="tick" x=${LEFT} y=${HEIGHT - 5}>1</text>
      <text class="tick" x=${WIDTH - 8} y=${HEIGHT - 5} text-anchor="end">${budget} photos</text>
      ${[...LANES].reverse().map(({ lane }) => trace(lane, all[lane][key], x, y))}
    </svg>
    <ul class="lanes">${LANES.map(({ lane, title }) => html`<li><span class="swatch ${lane}" aria-hidden="true"></span>${title} <b>${last(lane)}</b></li>`)}</ul>
  </figure>`;
}

function trace(lane: string, values: readonly number[], x: (n: number) => number, y: (v: number) => number): SVGTemplateResult {
  const points = values.map((value, index) => `${x(index + 1).toFixed(1)},${y(value).toFixed(1)}`);
  const end = points.at(-1)?.split(",");
  return svg`<polyline class="trace ${lane}" points=${points.join(" ")} />
    ${end ? svg`<circle class="end ${lane}" cx=${end[0] ?? 0} cy=${end[1] ?? 0} r="3" />` : null}`;
}

/** Four bars: what is expected so far, and how much the best further photo would add. */
export function bars(scores: Scores, gainLeft: Scores | null): TemplateResult {
  return html`<dl class="bars">${OBJECTIVES.map(({ name, title, says }) => {
    const score = Math.max(0, Math.min(1, scores[name]));
    const gain = gainLeft === null ? 0 : Math.max(0, Math.min(1 - score, gainLeft[name]));
    return html`<div title=${says}>
      <dt>${title}</dt>
      <dd><svg viewBox="0 0 100 8" preserveAspectRatio="none" aria-hidden="true">
        <rect class="track" width="100" height="8" /><rect class="score" width=${100 * score} height="8" />
        <rect class="gain" x=${100 * score} width=${100 * gain} height="8" />
      </svg><span>${percent(score)}${gain >= 0.0005 ? html` <small>+${percent(gain)}</small>` : null}</span></dd>
    </div>`;
  })}</dl>`;
}
