// What happens when a person does something: asks the worker, renders, tells the state.

import { Advice } from "./advice.js";
import { BOARD } from "./board.js";
import { Client } from "./client.js";
import type { Named, Parcel } from "./messages.js";
import { PLAIN, FOV_X_RAD } from "./layout.js";
import { lensOf, radians } from "./geometry.js";
import { type Event, type Screen, type State, canTake, initial, next } from "./state.js";
import type { Simulation } from "./simulation.js";
import type { LiveCapture, LiveSource } from "./camera/live.js";
import { offersAr } from "./camera/xr/offered.js";

/** Candidates and photos of a simulated capture. */
const SIMULATED = { count: 100, budget: 20, side: 512 };
/** When a further photo is no longer worth it: after 21 to 23 photos of the objects measured, where ten more
 *  add less than half a decibel (lab/RESULTS.md). */
export const STOP = { gain: 0.02, patience: 6 };

export class App {
  state: State = initial;
  readonly client = new Client();
  private simulation: Simulation | null = null;
  /** The camera at work; null until it was first started. */
  live: LiveCapture | null = null;
  private stopped = new AbortController();

  constructor(private show: (state: State) => void) {}

  dispatch = (event: Event): void => {
    this.state = next(this.state, event);
    this.show(this.state);
    if (event.type === "captured") void this.fetchThumbnails();
    if (["captured", "turned", "went"].includes(event.type)) this.simulation?.paint(this.state);
  };

  async open(): Promise<void> {
    try {
      const { engine, kept } = await this.client.ask({ type: "open" });
      this.dispatch({ type: "opened", engine, kept });
    } catch (error) {
      this.dispatch({ type: "failed", message: error instanceof Error ? error.message : String(error) });
    }
  }

  /** Does one thing at a time; what goes wrong is said on the page. */
  async doing(what: string, act: () => Promise<void>): Promise<void> {
    if (this.state.busy !== null) return;
    this.dispatch({ type: "began", what });
    try {
      await act();
    } catch (error) {
      this.say(error);
    } finally {
      this.dispatch({ type: "ended" });
    }
  }

  say(error: unknown): void {
    const text = error instanceof Error ? error.message : String(error);
    if (!(error instanceof Advice)) console.error(error);
    this.dispatch({ type: "noticed", notice: { level: "error", text } });
  }

  go = (screen: Screen): void => {
    if (this.state.screen === "camera" && screen !== "camera") this.live?.stop();
    if (screen === "home") void this.open();
    if (screen === "setup") void offersAr().then((hasAr) => this.dispatch({ type: "sensed", hasAr }));
    this.stop();
    this.dispatch({ type: "went", screen });
    scrollTo(0, 0);
    document.querySelector<HTMLElement>("main h1, main h2")?.focus({ preventScroll: true });
  };

  /** Whether a capture that would be removed may go. */
  mayReplace(): boolean {
    const photos = this.state.view?.record.photos.length ?? this.state.kept?.photos ?? 0;
    if (photos === 0) return true;
    return confirm(`A new capture replaces the one with ${photos} photo${photos === 1 ? "" : "s"} that is kept in this browser. Go on?`);
  }

  simulate = (file: File | null): Promise<void> => {
    if (!this.mayReplace()) return Promise.resolve();
    return this.doing("Setting the object up", async () => {
      const { Simulation } = await import("./simulation.js");
      const simulation = await Simulation.open(file);
      const name = file ? file.name.replace(/\.glb$/i, "") : "toy engine";
      const { view } = await this.client.ask({
        type: "start",
        setup: {
          name,
          subject: file ? { kind: "file", name: file.name } : { kind: "built-in" },
          layout: PLAIN,
          lens: lensOf(SIMULATED.side, SIMULATED.side, FOV_X_RAD),
          pool: {
            space: { kind: "hemisphere", minElevationRad: radians(5), maxElevationRad: radians(75) },
            count: SIMULATED.count,
          },
          plan: { scheme: "support", budget: SIMULATED.budget, stop: STOP },
          ...(file ? { file } : {}),
        },
      });
      this.dispatch({ type: "discarded" });
      await this.enter(simulation, view);
    });
  };

  private async enter(simulation: Simulation, view: NonNullable<State["view"]>): Promise<void> {
    this.simulation?.dispose();
    this.simulation = simulation;
    this.dispatch({ type: "captured", view });
    for await (const later of simulation.replay(this.client, view)) this.dispatch({ type: "captured", view: later });
    this.go("simulate");
  }

  resume = (): Promise<void> =>
    this.doing("Opening the capture", async () => {
      const { view } = await this.client.ask({ type: "resume" });
      await this.goOn(view);
    });

  /** Goes on with the capture of this page that was imported. */
  adopt = (): Promise<void> => {
    if (!this.mayReplace()) return Promise.resolve();
    return this.doing("Taking the photos in", async () => {
      const { view } = await this.client.ask({ type: "adopt" });
      await this.goOn(view);
    });
  };

  private async goOn(view: NonNullable<State["view"]>): Promise<void> {
    // Pictures of another capture with the same numbers must not stay.
    this.dispatch({ type: "discarded" });
    const { subject } = view.record;
    if (subject.kind === "camera") {
      this.dispatch({ type: "captured", view });
      this.go("review");
      return;
    }
    const { Simulation } = await import("./simulation.js");
    const file = subject.kind === "file" ? (await this.client.ask({ type: "subject" })).blob : null;
    await this.enter(await Simulation.open(file), view);
  }

  discard = (): Promise<void> => {
    if (!this.mayReplace()) return Promise.resolve();
    return this.doing("Removing the capture", async () => {
      await this.client.ask({ type: "discard" });
      this.dispatch({ type: "discarded" });
    });
  };

  takeNext = (): Promise<void> => this.doing("Taking the photo", () => this.takeOne());

  private async takeOne(): Promise<void> {
    const { view } = this.state;
    if (!this.simulation || !view?.next) return;
    const shot = await this.simulation.shoot(view);
    const faces = Object.values(shot.faces ?? {}).map((ids) => ids.buffer as ArrayBuffer);
    const answer = await this.client.ask({ type: "shoot", shot }, [...(shot.picture ? [shot.picture] : []), ...faces]);
    this.dispatch({ type: "captured", view: answer.view });
  }

  /** Takes photo after photo until it is enough or someone stops it. */
  takeAll = (): Promise<void> =>
    this.doing("Taking photos", async () => {
      this.stopped = new AbortController();
      const { signal } = this.stopped;
      this.dispatch({ type: "running", isRunning: true });
      try {
        while (!signal.aborted && this.state.view?.next) {
          await this.takeOne();
          await this.simulation?.settle();
        }
      } finally {
        this.dispatch({ type: "running", isRunning: false });
      }
    });

  stop = (): void => this.stopped.abort();

  skip = (): Promise<void> => this.change("skip");
  block = (): Promise<void> => this.change("block");

  private change(type: "skip" | "block"): Promise<void> {
    const candidate = this.state.view?.next?.index;
    if (candidate === undefined || !canTake(this.state)) return Promise.resolve();
    return this.doing("Planning around it", async () => {
      const { view } = await this.client.ask({ type, candidate });
      this.dispatch({ type: "captured", view });
    });
  }

  more = (): Promise<void> =>
    this.doing("Planning further", async () => {
      const { view } = await this.client.ask({ type: "more", views: 6 });
      this.dispatch({ type: "captured", view });
    });

  remove = (number: number): Promise<void> =>
    this.doing("Deleting the photo", async () => {
      let { view } = await this.client.ask({ type: "delete", number });
      this.dispatch({ type: "captured", view });
      if (this.simulation) {
        for await (view of this.simulation.replay(this.client, view)) this.dispatch({ type: "captured", view });
      }
    });

  rank = (): Promise<void> =>
    this.doing("Comparing the photos", async () => {
      const { order } = await this.client.ask({ type: "best" });
      this.dispatch({ type: "ranked", order });
    });

  save = (): Promise<void> =>
    this.doing("Packing and checking the zip", async () => {
      const { parcel } = await this.client.ask({ type: "export" });
      const { blob, ...rest }: Parcel = parcel;
      if (this.state.parcel) URL.revokeObjectURL(this.state.parcel.url);
      this.dispatch({ type: "packed", parcel: { ...rest, url: URL.createObjectURL(blob), size: blob.size } });
    });

  importFiles = (files: Named[]): Promise<void> => {
    if (files.length === 0) return Promise.resolve();
    return this.doing("Looking at the photos", async () => {
      const { report } = await this.client.ask({ type: "import", files });
      this.dispatch({ type: "reported", report });
      scrollTo(0, 0);
    });
  };

  /** A file that was dropped or chosen: a model to photograph, or photos to look at. */
  take = (files: Named[]): Promise<void> => {
    const [only] = files;
    if (files.length === 1 && only && /\.(glb|gltf|obj)$/i.test(only.path)) {
      return this.simulate(new File([only.file], only.path.slice(only.path.lastIndexOf("/") + 1)));
    }
    return this.importFiles(files);
  };

  /** Shows the board to print, and opens the browser's print dialogue, which also saves PDFs. */
  printBoard = (page: "a4" | "letter", isPrinted: boolean): Promise<void> =>
    this.doing("Drawing the board", async () => {
      const { svg } = await this.client.ask({ type: "board", spec: BOARD, page });
      if (this.state.board.svgUrl) URL.revokeObjectURL(this.state.board.svgUrl);
      const svgUrl = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
      this.dispatch({ type: "boarded", board: { page, svgUrl } });
      await document.querySelector<HTMLImageElement>(".sheet")?.decode();
      if (isPrinted) print();
    });

  /** Opens the camera for a new capture, or to go on with the one there is. */
  startCamera = (source: LiveSource, isNew: boolean): Promise<void> => {
    if (isNew && !this.mayReplace()) return Promise.resolve();
    return this.doing("Starting the camera", async () => {
      const { LiveCapture } = await import("./camera/live.js");
      this.live ??= new LiveCapture(this);
      await this.live.start(source, this.state.board.objectM, isNew);
    });
  };

  private async fetchThumbnails(): Promise<void> {
    for (const { number } of this.state.view?.record.photos ?? []) {
      if (this.state.thumbnails.has(number)) continue;
      try {
        const { blob } = await this.client.ask({ type: "photo", number });
        if (!this.state.thumbnails.has(number)) this.dispatch({ type: "pictured", number, url: URL.createObjectURL(blob) });
      } catch (error) {
        if (this.state.view?.record.photos.some((photo) => photo.number === number)) this.say(error);
      }
    }
  }
}
