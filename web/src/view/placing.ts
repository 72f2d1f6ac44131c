// In AR, before the first photo: the object is placed by aiming at its middle from two sides.

import { type TemplateResult, html, nothing } from "lit-html";
import type { App } from "../app.js";
import { LOST } from "../camera/hints.js";
import { TRUST } from "../record.js";
import type { Live, State } from "../state.js";

export function placing(state: State, { aim }: NonNullable<Live["placing"]>, app: App): TemplateResult {
  const { tracked, size } = state.live;
  const { width, height } = size ?? { width: 3, height: 4 };
  // Where the optical axis meets the picture, which fills the screen.
  const { cx, cy } = tracked?.lens ?? { cx: width / 2, cy: height / 2 };
  const isLost = tracked !== null && tracked.pose === null;
  return html`
    <section class="panel live" aria-label="Place the object">
      <div class="stagebox">
        <svg class="overlay" viewBox="0 0 ${width} ${height}" aria-hidden="true"><path class="cross" transform="translate(${cx} ${cy}) scale(${0.01 * Math.min(width, height)})" d="M-9 0H-2M2 0H9M0-9V-2M0 2V9" /></svg>
        ${isLost ? html`<p class="tip stop" data-hint="lost" role="status">${LOST.webxr}</p>` : nothing}
      </div>
      <div class="say">
        <h1 tabindex="-1" aria-live="polite">${aim === null ? "Aim at the object’s middle" : "And once more, from a quarter round"}</h1>
        <p>${aim === null
          ? "Stand where you would photograph it, the cross on its middle. Nothing may move from now on."
          : "Walk a quarter round the object and put the cross on the same middle."}</p>
      </div>
      <div class="actions centred">
        <button type="button" @click=${() => app.go("setup")}>Leave AR</button>
        <button type="button" class="main" ?disabled=${state.busy !== null || !tracked?.pose} @click=${app.live?.place}>The cross is on it</button>
      </div>
      <p class="hint">Poses: <b>${TRUST.webxr.title}</b>, ${TRUST.webxr.trust}.</p>
    </section>`;
}
