// The camera screen: the picture with its target, one line that says what to do, the shutter.

import { type TemplateResult, html, nothing, svg } from "lit-html";
import type { App } from "../app.js";
import { position } from "../geometry.js";
import { directionOf } from "../layout.js";
import type { CaptureView } from "../messages.js";
import { TRUST } from "../record.js";
import type { Live, State } from "../state.js";
import { way } from "../words.js";
import { placing } from "./placing.js";
import { guidance, outlook, room, sceneOf, strip, turnableDome } from "./parts.js";

export function camera(state: State, app: App): TemplateResult {
  const { view, live } = state;
  if (app.live && live.placing) return placing(state, live.placing, app);
  if (!view || !app.live) return html`<section class="panel narrow"><h1 tabindex="-1">The camera is off</h1><button type="button" class="main" @click=${() => app.go("setup")}>Set up a capture</button></section>`;
  const { width, height } = live.size ?? { width: 4, height: 3 };
  return html`
    <section class="panel live" aria-label="Camera">
      <div class="stagebox ${live.guide?.isReady ? "ready" : ""}">
        ${app.live.picture}
        <svg class="overlay" viewBox="0 0 ${width} ${height}" aria-hidden="true">${overlay(live, width, height)}</svg>
        ${live.flashes > 0 ? html`<div class="flash ${live.flashes % 2 === 0 ? "even" : "odd"}"></div>` : nothing}
        ${hint(live)}
      </div>
      <div class="say">
        <h1 tabindex="-1" aria-live="polite">${instruction(view, live)}</h1>
        <p>${guidance(view)}</p>
      </div>
      <div class="shutterrow">
        <button type="button" ?disabled=${state.busy !== null || !view.next} @click=${app.block}>Can’t get there</button>
        <button type="button" class="shutter" ?disabled=${state.busy !== null} @click=${app.live.shoot} aria-label="Take a photo now"><span></span></button>
        <button type="button" ?disabled=${view.record.photos.length === 0} @click=${() => app.go("review")}>${live.source === "webxr" ? "Finish" : "Review"} (${view.record.photos.length})</button>
      </div>
      <div class="toggles">
        <label><input type="checkbox" .checked=${live.isAutomatic} @change=${toggle(app, "isAutomatic")} /> Take photos by itself</label>
        <label><input type="checkbox" .checked=${live.isSpoken} @change=${toggle(app, "isSpoken")} /> Speak</label>
      </div>
      ${strip(state, app)}
    </section>
    <section class="panel" aria-labelledby="dome-title">
      <h2 id="dome-title">Places around the object</h2>
      ${turnableDome(sceneOf(view, here(view, live)), state, app)}
    </section>
    <section class="panel" aria-labelledby="progress-title">
      <h2 id="progress-title">How far</h2>
      ${outlook(view)}${room(view)}
      ${view.finish && view.finish !== "nothing-left" ? html`<button type="button" ?disabled=${state.busy !== null} @click=${app.more}>Take more</button>` : nothing}
      <p class="hint">Poses: <b>${TRUST[live.source].title}</b>, ${TRUST[live.source].trust}.${lensWords(live)}</p>
    </section>`;
}

const toggle = (app: App, name: "isAutomatic" | "isSpoken") => ({ target }: Event): void => {
  if (target instanceof HTMLInputElement) app.dispatch({ type: "lived", live: { [name]: target.checked } });
};

function here(view: CaptureView, { tracked }: Live): ReturnType<typeof directionOf> | null {
  return tracked?.pose ? directionOf(view.record.layout, position(tracked.pose)) : null;
}

function lensWords({ source, tracked }: Live): string {
  if (source !== "board" || !tracked) return "";
  return tracked.lensSource === "calibrated" ? " The lens has calibrated itself." : " The lens is still assumed: it calibrates itself as you move.";
}

/** The one line: what to do now. */
export function instruction(view: CaptureView, { guide, tracked, source }: Live): string {
  if (!view.next) return "You can stop here";
  if (!guide || !tracked?.pose) return source === "webxr" ? "Look around slowly" : "Point at the board";
  if (guide.isInZone) return guide.isReady ? "Hold still…" : "You are there";
  const from = directionOf(view.record.layout, position(tracked.pose));
  // Coarse, so that it can be read, and read out, while the camera moves.
  const words = way(from, position(view.next.pose), 10);
  return `Move ${words}`;
}

function hint({ guide }: Live): TemplateResult | typeof nothing {
  const [first] = [...(guide?.hints ?? [])].sort((a, b) => Number(b.level === "stop") - Number(a.level === "stop"));
  return first ? html`<p class="tip ${first.level}" data-hint=${first.name} role="status">${first.text}</p>` : nothing;
}

/** The tags that were found, the soft target and the arrow to it, the middle that it should reach. */
function overlay({ guide, tracked, steady }: Live, width: number, height: number): TemplateResult | ReturnType<typeof svg> {
  const short = Math.min(width, height);
  const [cx, cy] = [width / 2, height / 2];
  const tags = (tracked?.corners ?? []).map((c) => svg`<polygon class="tagline" points="${c[0] ?? 0},${c[1] ?? 0} ${c[2] ?? 0},${c[3] ?? 0} ${c[4] ?? 0},${c[5] ?? 0} ${c[6] ?? 0},${c[7] ?? 0}" />`);
  const r = 0.13 * short;
  if (!guide?.target) return svg`${tags}`;
  const [x, y] = [cx + guide.target.x * 0.5 * short, cy + guide.target.y * 0.5 * short];
  const away = Math.hypot(x - cx, y - cy);
  const [ux, uy] = away > 0 ? [(x - cx) / away, (y - cy) / away] : [0, 0];
  const from = 0.07 * short;
  const arrow = guide.isInZone || away < r ? null : svg`<path class="arrow" d="M${cx + ux * from} ${cy + uy * from}L${x - ux * r * 1.15} ${y - uy * r * 1.15}" marker-end="url(#tip)" />`;
  const turn = 2 * Math.PI * 0.05 * short;
  return svg`<defs><marker id="tip" viewBox="0 0 10 10" refX="7" refY="5" markerWidth="3.4" markerHeight="3.4" orient="auto"><path d="M0 0 10 5 0 10Z" /></marker></defs>
    ${tags}${arrow}
    <circle class="zone ${guide.isInZone ? "in" : ""}" cx=${x} cy=${y} r=${r} />
    <circle class="aim" cx=${cx} cy=${cy} r=${0.05 * short} />
    <circle class="steady" cx=${cx} cy=${cy} r=${0.05 * short} stroke-dasharray="${steady * turn} ${turn}" transform="rotate(-90 ${cx} ${cy})" />`;
}
