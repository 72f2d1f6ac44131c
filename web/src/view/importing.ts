// What an imported capture lacks: the views to take next.

import { type TemplateResult, html, nothing } from "lit-html";
import type { App } from "../app.js";
import { bars } from "../chart.js";
import { position, unit } from "../geometry.js";
import { directionOf } from "../layout.js";
import type { ImportReport } from "../messages.js";
import type { State } from "../state.js";
import { percent, reasonWords } from "../words.js";
import { turnableDome } from "./parts.js";

export function importing(state: State, app: App): TemplateResult {
  const { report } = state;
  if (!report) return html`<section class="panel narrow"><h1 tabindex="-1">Nothing was opened</h1></section>`;
  const gain = report.gainLeft ? Math.max(...Object.values(report.gainLeft).filter(Number.isFinite)) : null;
  return html`
    <section class="panel" aria-labelledby="import-title">
      <h1 id="import-title" tabindex="-1">${report.name}: ${report.photos.length} photos</h1>
      <p>Written by ${report.origin}. ${report.isEnough ? html`<b>These photos are good enough</b>: a further one would add little.` : html`<b>Something is missing</b>: the best further photo would add up to ${percent(gain ?? 0)}.`}</p>
      ${report.scores ? html`${bars(report.scores, report.gainLeft)}<p class="hint">Expected by the network, not measured.</p>` : nothing}
      ${report.canResume ? html`<button type="button" class="main" ?disabled=${state.busy !== null} @click=${app.adopt}>Go on with this capture</button>` : nothing}
      ${troubles(report)}
    </section>
    <section class="panel" aria-labelledby="places-title">
      <h2 id="places-title">Where photos are, and where to go</h2>
      ${turnableDome(scene(report), state, app)}
      <ul class="legend"><li><i class="visited"></i>photo</li><li><i class="next"></i>first to take</li><li><i class="available"></i>further ones</li></ul>
    </section>
    <section class="panel wide" aria-labelledby="reshoot-title">
      <h2 id="reshoot-title">Take these next</h2>
      <ol class="reshoot">${report.reshoot.map((view) => html`<li>
        <p><b>Stand at <code>${view.nearest}</code>, then go ${view.way}</b></p>
        <p>${reasonWords(view.reason)}</p>
      </li>`)}</ol>
      <button type="button" @click=${() => download(report)}>Save the list with its poses</button>
    </section>`;
}

function scene(report: ImportReport): Parameters<typeof turnableDome>[0] {
  return {
    candidates: Float32Array.from(report.reshoot.flatMap(({ planPose }) => [...planPose])),
    statuses: report.reshoot.map(() => "available"),
    next: report.reshoot.length > 0 ? 0 : null,
    isOrdered: false,
    way: report.photos.map(({ pose }) => unit(directionOf(report.layout, position(pose)))),
    here: null,
  };
}

/** Photos that could not be used, so many by name. */
const LISTED = 6;

function troubles({ skipped, notes }: ImportReport): TemplateResult | typeof nothing {
  if (skipped.length === 0 && notes.length === 0) return nothing;
  return html`<details ?open=${skipped.length > 0}>
    <summary>${skipped.length > 0 ? `${skipped.length} photo${skipped.length === 1 ? "" : "s"} could not be used` : "Notes"}</summary>
    <ul>${skipped.slice(0, LISTED).map(({ path, why }) => html`<li><code>${path}</code>: ${why}</li>`)}${skipped.length > LISTED ? html`<li>and ${skipped.length - LISTED} more</li>` : nothing}${notes.map((note) => html`<li>${note}</li>`)}</ul>
  </details>`;
}

/** The list as JSON: poses in the capture's own coordinates, as `vantage plan --photos` writes them. */
function download(report: ImportReport): void {
  const next = report.reshoot.map(({ pose, reason, nearest, way, gain }) => {
    const row = (start: number): number[] => [...pose.subarray(start, start + 4)];
    return { transform_matrix: [row(0), row(4), row(8), [0, 0, 0, 1]], reason, place: `${way} of ${nearest}`, gain };
  });
  const text = JSON.stringify({ capture: report.name, photos: report.photos.length, next }, null, 2);
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "application/json" }));
  link.download = `${report.name}-next.json`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
