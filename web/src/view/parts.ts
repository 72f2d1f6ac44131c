// Parts that several screens share: the dome, the progress, the film strip.

import { type TemplateResult, html, nothing } from "lit-html";
import type { App } from "../app.js";
import { bars } from "../chart.js";
import { type DomeScene, dome } from "../dome.js";
import { type Vec3, position } from "../geometry.js";
import { directionOf } from "../layout.js";
import type { CaptureView, Progress } from "../messages.js";
import type { State } from "../state.js";
import { clutterWords, finishWords, percent, reasonWords } from "../words.js";

export function sceneOf(view: CaptureView, here: Vec3 | null): DomeScene {
  const { layout, photos } = view.record;
  return {
    candidates: view.candidates,
    statuses: view.statuses,
    next: view.next?.index ?? null,
    isOrdered: true,
    way: photos.map((photo) => directionOf(layout, position(photo.pose))),
    here,
  };
}

/** The dome, to be turned by dragging or with the arrow keys. */
export function turnableDome(scene: DomeScene, state: State, app: App, inside: TemplateResult | typeof nothing = nothing): TemplateResult {
  const turn = (azimuthRad: number, elevationRad: number): void => app.dispatch({ type: "turned", azimuthRad, elevationRad });
  const drag = (event: PointerEvent): void => {
    if (event.buttons !== 1 || !(event.currentTarget instanceof HTMLElement)) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    turn(-event.movementX * 0.01, event.movementY * 0.01);
  };
  const key = (event: KeyboardEvent): void => {
    const steps: Record<string, [number, number]> = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, 0.15], ArrowDown: [0, -0.15] };
    const step = steps[event.key];
    if (!step) return;
    event.preventDefault();
    turn(...step);
  };
  return html`<div class="domeplace" tabindex="0" role="group" aria-label="Dome of views. Drag it, or use the arrow keys, to look from another side." @pointermove=${drag} @keydown=${key}>
    ${inside}${dome(scene, state.dome)}
  </div>`;
}

/** Why the next view, or why there is none. */
export function guidance(view: CaptureView): string {
  if (view.next) return reasonWords(view.next.reason);
  return view.finish ? finishWords(view.finish) : "";
}

/** What one more photo is expected to add to the best served of the four. */
export const bestGain = (progress: Progress): number => Math.max(0, ...Object.values(progress.gainLeft).filter(Number.isFinite));

/** Expected, and said to be so: four bars, what is left to gain, whether it is enough. */
export function outlook(view: CaptureView): TemplateResult {
  const { progress, record } = view;
  const taken = record.photos.length;
  const clutter = progress && clutterWords(progress.clutter);
  if (!progress) return html`<p class="hint">The first photos show where the object is interesting.</p>`;
  return html`
    <p class="verdict ${progress.isEnough ? "enough" : ""}">${progress.isEnough
      ? html`<b>Good enough from here.</b> A further photo would add less than ${percent(Math.max(0.001, bestGain(progress)))}.`
      : html`<b>${taken} of ${record.plan.budget}</b> photos. One more would add up to ${percent(bestGain(progress))}.`}</p>
    ${bars(progress.scores, progress.gainLeft)}
    ${clutter ? html`<p class="hint">${clutter}</p>` : nothing}
    <p class="hint">Expected by the network, not measured.</p>`;
}

/** Thumbnails of the photos in order, the newest last. */
export function strip(state: State, app: App): TemplateResult | typeof nothing {
  const photos = state.view?.record.photos ?? [];
  if (photos.length === 0) return nothing;
  return html`<ol class="strip" aria-label="Photos taken">${photos.map((photo) => html`<li>
    <button type="button" title="Photo ${photo.number}" aria-label="Photo ${photo.number}: open in the review" @click=${() => {
      app.go("review");
      app.dispatch({ type: "selected", number: photo.number });
    }}>${thumbnail(state, photo.number)}</button>
  </li>`)}</ol>`;
}

export function thumbnail(state: State, number: number): TemplateResult {
  const url = state.thumbnails.get(number);
  return url === undefined ? html`<span class="blank"></span>` : html`<img src=${url} alt="" decoding="async" />`;
}

/** How many photos still fit, once that is few. */
export function room(view: CaptureView): TemplateResult | typeof nothing {
  return view.room !== null && view.room < 20
    ? html`<p class="warning" role="status">The browser’s storage has room for about ${view.room} more photo${view.room === 1 ? "" : "s"}. Save the capture soon, or free some space.</p>`
    : nothing;
}
