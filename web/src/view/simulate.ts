// The simulated capture: what the camera sees, where it stands, how it compares.

import { type TemplateResult, html, nothing } from "lit-html";
import type { App } from "../app.js";
import { curves } from "../chart.js";
import { position } from "../geometry.js";
import type { CaptureView } from "../messages.js";
import { type State, canTake } from "../state.js";
import { direction } from "../words.js";
import { guidance, outlook, room, sceneOf, strip, turnableDome } from "./parts.js";

export function simulate(state: State, app: App): TemplateResult {
  const { view } = state;
  if (!view) return html`<p>There is no capture.</p>`;
  const taken = view.record.photos.length;
  return html`
    <section class="panel finder" aria-labelledby="finder-title">
      <h1 id="finder-title" tabindex="-1">${view.next ? `Next: photo ${taken + 1}` : "Done"}</h1>
      <div class="picture">
        <canvas id="finder" width="512" height="512" role="img" aria-label="What the camera sees from the next place"></canvas>
        <p class="why" role="status">${guidance(view)}${where(view)}</p>
      </div>
      <div class="actions">
        ${buttons(state, view, app)}
      </div>
      ${strip(state, app)}
    </section>
    <section class="panel" aria-labelledby="dome-title">
      <h2 id="dome-title">Places around the object</h2>
      ${turnableDome(sceneOf(view, null), state, app, html`<canvas id="in-dome" width="480" height="480" aria-hidden="true"></canvas>`)}
      <ul class="legend"><li><i class="next"></i>next</li><li><i class="visited"></i>taken</li><li><i class="available"></i>possible</li></ul>
    </section>
    <section class="panel" aria-labelledby="progress-title">
      <h2 id="progress-title">How far</h2>
      ${outlook(view)}${room(view)}
    </section>
    ${view.curves && taken > 0 ? html`<section class="panel comparison" aria-labelledby="curves-title">
      <h2 id="curves-title">Exact: how much of what can be seen from these places</h2>
      <div class="charts">
        ${curves(view.curves, "coverage", "Surface covered, %", view.record.plan.budget)}
        ${curves(view.curves, "diversity", "Ray diversity, %", view.record.plan.budget)}
      </div>
    </section>` : nothing}`;
}

function buttons(state: State, view: CaptureView, app: App): TemplateResult {
  const taken = view.record.photos.length;
  const review = html`<button type="button" class=${view.next ? "" : "main"} ?disabled=${taken === 0 || state.isRunning} @click=${() => app.go("review")}>Review and save</button>`;
  if (state.isRunning) return html`<button type="button" class="main" @click=${app.stop}>Stop</button>${review}`;
  if (!view.next) return html`${review}<button type="button" ?disabled=${state.busy !== null} @click=${app.more}>Take more</button>`;
  const isBlocked = !canTake(state);
  return html`
    <button type="button" class="main" ?disabled=${isBlocked} @click=${app.takeNext} aria-keyshortcuts="t">Take this photo</button>
    <button type="button" ?disabled=${isBlocked} @click=${app.takeAll}>Take all</button>
    <button type="button" ?disabled=${isBlocked} @click=${app.skip}>Not now</button>
    ${review}`;
}

function where(view: CaptureView): TemplateResult | typeof nothing {
  if (!view.next) return nothing;
  const { azimuthDeg, elevationDeg } = direction(position(view.next.pose));
  return html` <small>${Math.round((azimuthDeg + 360) % 360)}° around, ${Math.round(elevationDeg)}° up</small>`;
}
