// Before the camera: print the board, stand the object on it, say how large it is.

import { type TemplateResult, html, nothing } from "lit-html";
import type { App } from "../app.js";
import { TRUST } from "../record.js";
import type { State } from "../state.js";

const SIZES: readonly { metres: number; text: string }[] = [
  { metres: 0.05, text: "an egg · 5 cm" },
  { metres: 0.1, text: "a mug · 10 cm" },
  { metres: 0.18, text: "a shoe · 18 cm" },
  { metres: 0.3, text: "a lamp · 30 cm" },
];

export function setup(state: State, app: App): TemplateResult {
  const { board, busy, view, engine, hasAr } = state;
  const source = view && view.record.photos.length > 0 && view.record.subject.kind === "camera" ? view.record.subject.source : null;
  const isIdle = busy === null && engine !== null;
  return html`
    <ol class="steps">
      <li class="panel">
        <h1 tabindex="-1">1. Print the board</h1>
        <p>It tells the camera where it is, to the millimetre, in every browser. Print at 100 % on matt paper, and check the 100 mm bar with a ruler.</p>
        <fieldset class="choice"><legend>Paper</legend>${(["a4", "letter"] as const).map((page) => html`<label><input type="radio" name="paper" .checked=${board.page === page} @change=${() => app.printBoard(page, false)} /> ${page === "a4" ? "A4" : "Letter"}</label>`)}</fieldset>
        <div class="actions">
          <button type="button" class="main" ?disabled=${!isIdle} @click=${() => app.printBoard(board.page, true)}>Print, or save as PDF</button>
          ${board.svgUrl === null ? nothing : html`<a class="button" href=${board.svgUrl} download="vantage-board-${board.page}.svg">Save as SVG</a>`}
        </div>
        ${board.svgUrl === null ? nothing : html`<img class="sheet ${board.page}" src=${board.svgUrl} alt="The board: a grid of square tags" />`}
      </li>
      <li class="panel">
        <h2>2. Stand the object in its middle</h2>
        <p>On a flat table, with room to walk around. Soft, even light; no flash. Nothing may move once you begin.</p>
        <fieldset class="choice"><legend>About as large as</legend>${SIZES.map(({ metres, text }) => html`<label><input type="radio" name="size" .checked=${board.objectM === metres} @change=${() => app.dispatch({ type: "boarded", board: { objectM: metres } })} /> ${text}</label>`)}</fieldset>
      </li>
      <li class="panel">
        <h2>3. Follow the arrow</h2>
        <p>Bring the ring into the middle. The photo is taken when you are there and hold still.</p>
        <div class="actions">
          <button type="button" class="main" ?disabled=${!isIdle} @click=${() => app.startCamera("board", true)}>Start the camera</button>
          ${source === null || source === "webxr" ? nothing : html`<button type="button" ?disabled=${!isIdle} @click=${() => app.startCamera(source === "orientation" ? source : "board", false)}>Go on with ${view?.record.photos.length} photos</button>`}
        </div>
        ${source === "webxr" ? html`<p class="hint">The phone’s tracking begins anew each time, so no photo can be added to the capture that you have. Save that first.</p>` : nothing}
        ${hasAr ? html`<p><b>${TRUST.webxr.title}.</b> No board: the phone follows itself (${TRUST.webxr.trust}). You aim at the object’s middle from two sides, then follow the arrow. All in one go: leaving the camera ends it.</p>
          <button type="button" ?disabled=${!isIdle} @click=${() => app.startCamera("webxr", true)}>Start in AR, without a board</button>` : nothing}
        <details><summary>No printer?</summary>
          <p><b>${TRUST.orientation.title}.</b> The phone’s own sensor tells which way it looks: ${TRUST.orientation.trust}.</p>
          <button type="button" ?disabled=${!isIdle} @click=${() => app.startCamera("orientation", true)}>Start without a board</button>
        </details>
      </li>
    </ol>`;
}
