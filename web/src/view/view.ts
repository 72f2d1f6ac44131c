// State to view: the one function that says what the page looks like.

import { type TemplateResult, html, nothing } from "lit-html";
import type { App } from "../app.js";
import type { State } from "../state.js";
import { camera } from "./camera.js";
import { home } from "./home.js";
import { importing } from "./importing.js";
import { review } from "./review.js";
import { setup } from "./setup.js";
import { simulate } from "./simulate.js";

export function view(state: State, app: App): TemplateResult {
  return html`
    <header>
      <button class="brand" type="button" @click=${() => app.go("home")} aria-label="Vantage, start page">
        <svg viewBox="-12 -12 24 24" aria-hidden="true"><path d="M-9 5A10 10 0 0 1 9 5" /><circle r="3.2" cy="4" /><circle class="spot" r="2.6" cx="6.4" cy="-3.4" /></svg>
        Vantage
      </button>
      <p>${place(state)}</p>
    </header>
    <main class=${isAr(state) ? "camera ar" : state.screen}>${state.failure === null ? screen(state, app) : broken(state.failure)}</main>
    <div class="notices">
      <p class="busy" role="status">${state.busy === null || state.isRunning ? nothing : html`${state.busy}…`}</p>
      <div role="alert">${state.notice === null ? nothing : html`<p class="notice ${state.notice.level}">
        <span>${state.notice.text}</span>
        <button type="button" @click=${() => app.dispatch({ type: "noticed", notice: null })} aria-label="Close this message">✕</button>
      </p>`}</div>
    </div>`;
}

function screen(state: State, app: App): TemplateResult {
  switch (state.screen) {
    case "home":
      return home(state, app);
    case "simulate":
      return simulate(state, app);
    case "setup":
      return setup(state, app);
    case "camera":
      return camera(state, app);
    case "review":
      return review(state, app);
    case "import":
      return importing(state, app);
  }
}

/** Whether the system shows the camera's picture behind the page. */
const isAr = ({ screen, live }: State): boolean => screen === "camera" && live.source === "webxr";

/** Where things are kept, said in the header. */
function place({ engine, isOffline }: State): string {
  const where = engine?.storage === "memory" ? "Nothing is kept: this window has no storage" : "Stays on this device";
  return isOffline ? `Offline · ${where}` : where;
}

function broken(message: string): TemplateResult {
  return html`<section class="panel narrow" role="alert">
    <h1>This browser cannot run the planner</h1>
    <p>${message}</p>
    <p>A current Chrome, Edge, Firefox or Safari can: it needs WebAssembly and module workers. Photos that were kept here stay where they are.</p>
    <button type="button" @click=${() => location.reload()}>Try again</button>
  </section>`;
}
