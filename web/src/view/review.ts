// The gallery: what each photo added and how sharp it is; delete, choose the best, save.

import { type TemplateResult, html, nothing } from "lit-html";
import type { App } from "../app.js";
import type { CaptureView } from "../messages.js";
import { type PhotoRecord, TRUST } from "../record.js";
import type { State } from "../state.js";
import { OBJECTIVES, bytes, percent, reasonWords } from "../words.js";
import { outlook, thumbnail } from "./parts.js";

export function review(state: State, app: App): TemplateResult {
  const { view } = state;
  if (!view) return html`<section class="panel narrow"><h1 tabindex="-1">No capture</h1><p>There is nothing to review yet.</p></section>`;
  const { photos } = view.record;
  const isIdle = state.busy === null;
  return html`
    <h1 id="review-title" class="wide" tabindex="-1">${view.record.name}: ${photos.length} photo${photos.length === 1 ? "" : "s"}</h1>
    ${saving(state, view, app)}
    <section class="panel" aria-labelledby="outlook-title"><h2 id="outlook-title">What is still to gain</h2>${outlook(view)}</section>
    <section class="panel wide" aria-labelledby="gallery-title">
      <h2 id="gallery-title">Photos</h2>
      <div class="actions">
        <button type="button" ?disabled=${!isIdle} @click=${() => app.go(view.record.subject.kind === "camera" ? "setup" : "simulate")}>Take more photos</button>
        <button type="button" ?disabled=${!isIdle || photos.length < 2} @click=${app.rank}>Find the best</button>
      </div>
      ${best(state, app)}
      <ol class="gallery">${photos.map((photo) => card(photo, view, state, app))}</ol>
    </section>`;
}

/** The gain of a photo in the objective that it served best. */
function gainWords(photo: PhotoRecord): string {
  if (!photo.gain) return "";
  const gain = photo.gain;
  const [most] = [...OBJECTIVES].sort((a, b) => gain[b.name] - gain[a.name]);
  return most && gain[most.name] >= 0.0005 ? `+${percent(gain[most.name])} ${most.title.toLowerCase()}` : "added little";
}

/** Photos much less sharp than the middle one are marked. */
export function isSoft(photo: PhotoRecord, all: readonly PhotoRecord[]): boolean {
  const known = all.map((other) => other.quality?.sharpness).filter((value) => value !== undefined).sort((a, b) => a - b);
  const middle = known[Math.floor(known.length / 2)];
  return middle !== undefined && photo.quality !== undefined && photo.quality.sharpness < 0.4 * middle;
}

function card(photo: PhotoRecord, view: CaptureView, state: State, app: App): TemplateResult {
  const isOpen = state.selected === photo.number;
  const rank = state.best ? state.best.order.indexOf(photo.number) : -1;
  const isLeftOut = state.best !== null && rank >= state.best.count;
  const isBlurred = isSoft(photo, view.record.photos);
  const ranked = rank >= 0 && !isLeftOut ? `best ${rank + 1}` : null;
  const label = `Photo ${photo.number}${ranked === null ? "" : ` ${ranked}`}, ${gainWords(photo)}${isBlurred ? ", soft" : ""}`;
  return html`<li class="card ${isLeftOut ? "leftout" : ""} ${isOpen ? "open" : ""}">
    <button type="button" class="face" aria-expanded=${isOpen} aria-label=${label} @click=${() => app.dispatch({ type: "selected", number: isOpen ? null : photo.number })}>
      ${thumbnail(state, photo.number)}
      <span class="tag" aria-hidden="true">${photo.number}</span>
      ${ranked === null ? nothing : html`<span class="tag rank" aria-hidden="true">${ranked}</span>`}
    </button>
    <p>${gainWords(photo)}${isBlurred ? html` <span class="soft">soft</span>` : nothing}</p>
    ${isOpen ? details(photo, state, app) : nothing}
  </li>`;
}

function details(photo: PhotoRecord, state: State, app: App): TemplateResult {
  const reason = photo.reason === null ? "Chosen by you." : reasonWords(photo.reason);
  const { title, trust } = TRUST[photo.source];
  return html`<div class="details">
    <p>${reason}</p>
    <dl>
      ${photo.gain ? OBJECTIVES.map(({ name, title }) => html`<dt>${title}</dt><dd>${photo.gain ? `+${percent(Math.max(0, photo.gain[name]))}` : ""}</dd>`) : nothing}
      ${photo.quality ? html`<dt>Sharpness</dt><dd>${photo.quality.sharpness.toPrecision(3)}</dd>` : nothing}
      <dt>Pose</dt><dd>${title}: ${trust}</dd>
      <dt>Size</dt><dd>${bytes(photo.bytes)}</dd>
    </dl>
    <button type="button" class="danger" ?disabled=${state.busy !== null} @click=${() => app.remove(photo.number)}>Delete, and plan it anew</button>
  </div>`;
}

function best({ best }: State, app: App): TemplateResult | typeof nothing {
  if (!best) return nothing;
  return html`<label class="slider">The best <b>${best.count}</b> of ${best.order.length}, if fewer must do
    <input type="range" min="1" max=${best.order.length} .value=${String(best.count)} @input=${({ target }: Event) => {
      if (target instanceof HTMLInputElement) app.dispatch({ type: "counted", count: target.valueAsNumber });
    }} />
  </label>`;
}

function saving(state: State, view: CaptureView, app: App): TemplateResult {
  const { parcel, busy } = state;
  const none = view.record.photos.length === 0;
  return html`<section class="panel" aria-labelledby="save-title">
    <h2 id="save-title">Save for training</h2>
    ${parcel === null
      ? html`<p>One zip for nerfstudio, brush, gsplat, Inria’s 3DGS, instant-ngp and COLMAP, with the command for each inside.</p>
        <button type="button" class="main" ?disabled=${busy !== null || none} @click=${app.save}>Pack the zip</button>`
      : html`<ul class="checks">${parcel.checks.map((check) => html`<li>${check}</li>`)}</ul>
        <a class="button main" id="download" href=${parcel.url} download=${parcel.name}>Save ${parcel.name} (${bytes(parcel.size)})</a>
        <p class="hint">Then, in the unzipped folder: <code>ns-train splatfacto --data .</code></p>`}
  </section>`;
}
