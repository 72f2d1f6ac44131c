// The page: events change the state, the state makes the view.

import { render } from "lit-html";
import { App } from "./app.js";
import { dropped } from "./drop.js";
import { view } from "./view/view.js";

const root = document.querySelector<HTMLElement>("#app");
if (!root) throw new Error("index.html lacks #app");

const app = new App((state) => render(view(state, app), root));
app.dispatch({ type: "connected", isOffline: !navigator.onLine });
void app.open();

for (const name of ["online", "offline"]) {
  window.addEventListener(name, () => app.dispatch({ type: "connected", isOffline: !navigator.onLine }));
}

// Files may be dropped anywhere.
window.addEventListener("dragover", (event) => event.preventDefault());
window.addEventListener("drop", (event) => {
  event.preventDefault();
  dropped(event.dataTransfer).then(app.take, (error: unknown) => app.say(error));
});

window.addEventListener("keydown", (event) => {
  const isTyping = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
  if (isTyping || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "t" && app.state.screen === "simulate") void app.takeNext();
});

if (import.meta.env.PROD && "serviceWorker" in navigator) {
  window.addEventListener("load", () => {
    // Without it the page works, only not offline.
    navigator.serviceWorker.register(new URL("sw.js", document.baseURI)).catch(() => undefined);
  });
}
