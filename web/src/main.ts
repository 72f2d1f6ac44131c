// The page: events change the state, the state makes the view. Planning happens in the worker.

import { draw } from "./dome.js";
import { order } from "./form.js";
import type { Reply, Request } from "./messages.js";
import { type Event, type State, direction, guidance, initial, next, position } from "./state.js";
import { forget, keep, kept } from "./storage.js";
import { transforms } from "./transforms.js";

/** An element that index.html has. */
function part<T extends HTMLElement>(id: string, kind: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`the page lacks #${id}`);
  return found;
}

const page = {
  form: part("plan", HTMLFormElement),
  dome: part("dome", HTMLDivElement),
  next: part("next", HTMLParagraphElement),
  error: part("error", HTMLParagraphElement),
  take: part("take", HTMLButtonElement),
  skip: part("skip", HTMLButtonElement),
  block: part("block", HTMLButtonElement),
  finish: part("finish", HTMLButtonElement),
  download: part("download", HTMLButtonElement),
  progress: part("progress", HTMLProgressElement),
  tour: part("tour", HTMLParagraphElement),
  views: part("views", HTMLOListElement),
};

let state: State = initial;
const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });

function dispatch(event: Event): void {
  state = next(state, event);
  show(state);
}

/** State to view: the only function that changes the page. */
function show(state: State): void {
  const { progress, waiting } = state;
  draw(page.dome, state);
  page.next.textContent = guidance(state);
  page.error.textContent = state.error ?? "";
  const canAct = !waiting && progress !== null && progress.next !== null;
  for (const button of [page.take, page.skip, page.block, page.finish]) button.disabled = !canAct;
  const taken = progress?.views.length ?? 0;
  page.download.disabled = taken === 0;
  page.progress.max = Math.max(state.budget, 1);
  page.progress.value = taken;
  page.tour.textContent =
    taken > 1 && progress !== null
      ? `${taken} of ${state.budget} taken. Taken again in the shortest order, the camera would ` +
        `turn ${Math.round((progress.tour.lengthRad * 180) / Math.PI)}° in all.`
      : `${taken} of ${state.budget} taken.`;
  page.views.replaceChildren(...(progress?.views ?? []).map((index) => listed(state, index)));
}

function listed(state: State, index: number): HTMLLIElement {
  const item = document.createElement("li");
  const { azimuthDeg, elevationDeg } = direction(state.poses.subarray(12 * index, 12 * index + 12));
  const range = Math.hypot(...position(state.poses, index));
  item.textContent =
    `view ${index}: ${azimuthDeg.toFixed(0)}° around, ${elevationDeg.toFixed(0)}° up, ` +
    `${range.toFixed(2)} m away`;
  return item;
}

function ask(request: Request): void {
  worker.postMessage(request);
}

function start(): void {
  const fields = new FormData(page.form);
  dispatch({ type: "asked-anew" });
  ask({ type: "start", run: state.run, ...order((name) => String(fields.get(name) ?? "")) });
}

function act(type: "take" | "skip" | "block"): void {
  const index = state.progress?.next?.index;
  if (index === undefined || state.waiting) return;
  dispatch({ type: "asked" });
  ask({ type, run: state.run, index });
}

worker.addEventListener("message", ({ data }: MessageEvent<Reply>) => {
  // What was kept does not fit this version or is damaged: begin afresh.
  const begins = state.progress === null && kept() !== null;
  dispatch({ type: "replied", reply: data });
  if (data.run !== state.run) return;
  if (data.type === "progress") keep(data.progress.snapshot);
  if (data.type === "refused" && begins) {
    forget();
    start();
  }
});
worker.addEventListener("error", () => {
  dispatch({ type: "invalid", message: "The planner could not be loaded; reload the page." });
});

page.form.addEventListener("submit", (event) => {
  event.preventDefault();
  start();
});
page.take.addEventListener("click", () => act("take"));
page.skip.addEventListener("click", () => act("skip"));
page.block.addEventListener("click", () => act("block"));
page.finish.addEventListener("click", () => {
  if (state.waiting) return;
  dispatch({ type: "asked" });
  ask({ type: "take-all", run: state.run });
});
page.download.addEventListener("click", () => {
  if (state.progress === null) return;
  const text = `${JSON.stringify(transforms(state.progress.viewPoses), null, 2)}\n`;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "application/json" }));
  link.download = "transforms.json";
  link.click();
  // The download has its own hold on the data by the next turn of the loop.
  setTimeout(() => URL.revokeObjectURL(link.href));
});

document.addEventListener("keydown", (event) => {
  const inField = event.target instanceof Element && event.target.closest("input, select") !== null;
  if (inField || event.ctrlKey || event.metaKey || event.altKey) return;
  const actions: Record<string, () => void> = {
    t: () => act("take"),
    s: () => act("skip"),
    b: () => act("block"),
  };
  actions[event.key.toLowerCase()]?.();
});

const STEP_RAD = Math.PI / 24;
page.dome.addEventListener("keydown", (event) => {
  const turns: Record<string, [number, number]> = {
    ArrowLeft: [-STEP_RAD, 0],
    ArrowRight: [STEP_RAD, 0],
    ArrowUp: [0, STEP_RAD],
    ArrowDown: [0, -STEP_RAD],
  };
  const turn = turns[event.key];
  if (turn === undefined) return;
  event.preventDefault();
  dispatch({ type: "turned", azimuthRad: turn[0], elevationRad: turn[1] });
});
page.dome.addEventListener("pointerdown", (event) => page.dome.setPointerCapture(event.pointerId));
page.dome.addEventListener("pointermove", (event) => {
  if (!page.dome.hasPointerCapture(event.pointerId)) return;
  const scale = Math.PI / Math.max(page.dome.clientWidth, 1);
  dispatch({
    type: "turned",
    azimuthRad: -event.movementX * scale,
    elevationRad: event.movementY * scale,
  });
});

const snapshot = kept();
if (snapshot === null) {
  start();
} else {
  dispatch({ type: "asked-anew" });
  ask({ type: "restore", run: state.run, snapshot });
}
