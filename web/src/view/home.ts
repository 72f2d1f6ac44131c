// The first screen: what this is, and three ways in.

import { type TemplateResult, html, nothing } from "lit-html";
import type { App } from "../app.js";
import { chosen } from "../drop.js";
import type { State } from "../state.js";

export function home(state: State, app: App): TemplateResult {
  const isReady = state.engine !== null && state.busy === null;
  return html`
    <div class="hero">
      <h1 tabindex="-1">Photograph an object from the right places</h1>
      <p>Vantage leads you from view to view, says why, and says when it is enough. You leave with a folder that splat and NeRF trainers open.</p>
    </div>
    ${resume(state, app)}
    <div class="ways">
      <section class="way first">
        ${sketch("try")}
        <h2>Try it now</h2>
        <p>Watch it photograph a toy engine, beside three other ways to choose views. No camera needed.</p>
        <button class="main" type="button" ?disabled=${!isReady} @click=${() => app.simulate(null)}>Start with the toy engine</button>
        ${picker("Use your own GLB model", ".glb", isReady, false, app)}
      </section>
      <section class="way">
        ${sketch("camera")}
        <h2>Use the camera</h2>
        <p>Print a board, stand the object on it, follow the arrow. Best with a phone.</p>
        <button class="main" type="button" ?disabled=${!isReady} @click=${() => app.go("setup")}>Set up a capture</button>
      </section>
      <section class="way">
        ${sketch("check")}
        <h2>Check photos you have</h2>
        <p>A capture of nerfstudio, Polycam, Record3D, NeRFCapture or this page: what is missing, and what to shoot again.</p>
        ${picker("Choose a zip", ".zip", isReady, false, app)}
        ${picker("Choose a folder", "", isReady, true, app)}
      </section>
    </div>
    <p class="small">Photos and poses never leave this device. ${state.engine === null ? "Loading the planner…" : "Works offline once loaded."}</p>`;
}

function resume({ kept, view, busy }: State, app: App): TemplateResult | typeof nothing {
  const name = view?.record.name ?? kept?.name;
  const photos = view?.record.photos.length ?? kept?.photos ?? 0;
  if (name === undefined || photos === 0) return nothing;
  const begun = new Date(view?.record.startedAt ?? kept?.startedAt ?? 0);
  return html`<section class="resume" aria-label="Capture in progress">
    <p><b>${name}</b>, ${photos} photo${photos === 1 ? "" : "s"}, begun ${begun.toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" })}</p>
    <button class="main" type="button" ?disabled=${busy !== null} @click=${app.resume}>Go on</button>
    <button type="button" ?disabled=${busy !== null} @click=${app.discard}>Remove</button>
  </section>`;
}

/** A button that opens the file dialogue. */
function picker(text: string, accept: string, isReady: boolean, isFolder: boolean, app: App): TemplateResult {
  return html`<label class="button ${isReady ? "" : "disabled"}">${text}
    <input type="file" accept=${accept || nothing} ?webkitdirectory=${isFolder} ?disabled=${!isReady}
      @change=${({ target }: Event) => {
        if (!(target instanceof HTMLInputElement)) return;
        const files = chosen(target);
        target.value = "";
        void app.take(files);
      }} />
  </label>`;
}

function sketch(kind: "try" | "camera" | "check"): TemplateResult {
  const drawings = {
    try: html`<svg class="sketch" viewBox="0 0 120 64" aria-hidden="true"><path class="thin" d="M16 54a44 44 0 0 1 88 0" /><rect x="48" y="34" width="24" height="20" rx="4" /><circle cx="22" cy="32" r="4" /><circle cx="44" cy="13" r="4" /><circle class="spot" cx="82" cy="16" r="6" /><path class="thin" d="M78 21 66 32" /></svg>`,
    camera: html`<svg class="sketch" viewBox="0 0 120 64" aria-hidden="true"><path class="thin" d="M22 54 40 40H88L104 54Z" /><path class="thin" d="M40 54 52 40M58 54 64 40M76 54 76 40M92 54 88 40M30 48H97" /><rect x="52" y="26" width="22" height="20" rx="4" /><rect class="spotline" x="40" y="6" width="46" height="48" rx="7" /></svg>`,
    check: html`<svg class="sketch" viewBox="0 0 120 64" aria-hidden="true"><rect class="thin" x="20" y="12" width="30" height="24" rx="3" /><rect class="thin" x="56" y="12" width="30" height="24" rx="3" /><rect class="thin" x="20" y="40" width="30" height="16" rx="3" /><rect class="spotline" x="56" y="40" width="30" height="16" rx="3" /><path class="spotline" d="M71 44v8M67 48h8" /></svg>`,
  };
  return drawings[kind];
}
