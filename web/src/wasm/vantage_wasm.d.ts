/* tslint:disable */
/* eslint-disable */

/** A grid of AprilTags 36h11, numbered along the rows from the far left. The board's frame has its
 *  origin in the middle, x to the right, y to the far edge, z up; metres. What is left out is as
 *  in the usual board: 5 x 4 tags of 40 mm, 10 mm apart, from number 0. */
export type BoardSpec = {
    columns?: number; rows?: number; tagSizeM?: number; gapM?: number; firstId?: number;
};

/** Where intrinsics come from: a usual field of view, views of the board, the caller. */
export type IntrinsicsSource = "assumed" | "calibrated" | "given";

/** What a frame shows. `tags`: corners in pixels, 8 numbers, clockwise from the upright tag's upper
 *  left one. `pose`: rows of world_from_camera, in the board's frame; there with `rmsPx` (root mean
 *  square of the corners' reprojection errors), `tagsUsed` and `isAmbiguous` (another pose fits
 *  nearly as well), if any tag was seen. */
export type TrackResult = {
    tags: { id: number; corners: Float32Array }[];
    pose?: Float32Array; rmsPx?: number; isAmbiguous?: boolean; tagsUsed?: number;
    focalPx: number; cx: number; cy: number; intrinsicsSource: IntrinsicsSource;
};

/** What the views of the board tell of the camera; pixels. `focalSigmaPx` is a standard deviation. */
export type Calibration = {
    focalPx: number; cx: number; cy: number; rmsPx: number; views: number; focalSigmaPx: number;
};

/** How a frame looks. `sharpness`: variance of the Laplacian over variance; compare it with other
 *  frames of the same scene. `darkShare`, `brightShare`: shares of black and of blown-out pixels. */
export type FrameQuality = {
    sharpness: number; meanLuma: number; darkShare: number; brightShare: number;
};



/** From where a camera may look at the object; elevations are above the horizontal plane. */
export type ViewSpace =
| { kind: "random-sphere"; seed: number }
| { kind: "fibonacci-sphere" }
| { kind: "hemisphere"; minElevationRad: number; maxElevationRad: number }
| { kind: "rings"; rings: number; minElevationRad: number; maxElevationRad: number }
| { kind: "spiral"; turns: number; minElevationRad: number; maxElevationRad: number };



/** How the next view is chosen: by chance, farthest from all views so far, or the latter after
 *  the extreme views along the axes. */
export type PoseScheme = "random" | "farthest-point" | "pseudo-coverage";

/** A whole plan. `movementCost` in [0, 1] is the share of a gain that half a turn costs. */
export type PosePlan = {
    scheme: PoseScheme; budget: number; seed?: number; movementCost?: number;
};

/** The next view: its number, pose (rows of world_from_camera, 12 numbers), and why. `gainM` is
 *  the distance to the nearest view so far in metres, 0 where chance or the start chose. */
export type NextView = {
    index: number; pose: Float32Array; gainM: number;
    reason: "start" | "chance" | "farthest"; why: string;
};

/** Why there is no next view. */
export type Finish = "budget-spent" | "good-enough" | "nothing-left";

/** What has become of a candidate. */
export type Status = "available" | "visited" | "skipped" | "blocked";

/** Candidates in the order that moves the camera least, and the length of the way. */
export type Tour = { order: Uint32Array; lengthRad: number };



/** The `code` of every `Error` that this package throws. */
export type RefusalCode =
| "bad-argument" | "bad-pool" | "bad-plan" | "bad-pose"
| "unknown-candidate" | "too-large" | "bad-snapshot" | "other-version";



/**
 * Follows a camera by a printed board, and learns its intrinsics on the way.
 */
export class BoardTracker {
    free(): void;
    [Symbol.dispose](): void;
    /**
     * What the views so far tell of the camera; undefined while they do not tell it. `track` asks
     * by itself with every new side of the board.
     */
    calibrate(): Calibration | undefined;
    /**
     * Uses these intrinsics from now on; pixels of the frames that will come.
     */
    setIntrinsics(focalPx: number, cx: number, cy: number): void;
    /**
     * The board to print, true to size, with a bar of 100 mm to check.
     */
    svg(page: "a4" | "letter"): string;
    /**
     * Finds the board in a frame: one byte of luma for each pixel, row by row.
     *
     * Frames of another size than the ones before make it forget the calibration.
     */
    track(luma: Uint8Array | number[], width: number, height: number): TrackResult;
    /**
     * A tracker of a board, with a camera that nothing is known of.
     */
    constructor(spec?: BoardSpec);
}

/**
 * A numbered set of poses in a view space, all looking at the world's origin.
 */
export class Pool {
    free(): void;
    [Symbol.dispose](): void;
    /**
     * All poses, shape (length, 3, 4): the rows of `world_from_camera`.
     */
    poses(): Float32Array;
    /**
     * `count` views of a space at `radiusM` metres from the origin.
     */
    constructor(space: ViewSpace, count: number, radiusM: number);
    /**
     * How many views there are.
     */
    readonly length: number;
}

/**
 * A capture in progress.
 */
export class Session {
    free(): void;
    [Symbol.dispose](): void;
    /**
     * Candidate `index` cannot be reached.
     */
    block(index: number): void;
    /**
     * Why there is no next view; undefined while there is one.
     */
    finish(): Finish | undefined;
    /**
     * Where to stand next; undefined when the session is over. Asking again changes nothing.
     */
    nextView(): NextView | undefined;
    /**
     * Takes in that candidate `index` was photographed, at `pose` if not exactly at its own.
     */
    observe(index: number, pose?: Float32Array): void;
    /**
     * All poses of the candidates, shape (candidates, 3, 4).
     */
    poses(): Float32Array;
    /**
     * The session that wrote these bytes.
     */
    static restore(bytes: Uint8Array | number[]): Session;
    /**
     * Not candidate `index` now; perhaps after the next photo.
     */
    skip(index: number): void;
    /**
     * The session as bytes, to go on after a reload.
     */
    snapshot(): Uint8Array;
    /**
     * What has become of every candidate, in order.
     */
    statuses(): Status[];
    /**
     * Puts candidates into the order that moves the camera least, from the last view on.
     */
    tour(indices: Uint32Array | number[]): Tour;
    /**
     * A session over the views of a pool.
     */
    constructor(pool: Pool, plan: PosePlan);
    /**
     * Candidate `index` can be reached after all.
     */
    unblock(index: number): void;
    /**
     * The poses at which photos were really taken, shape (views, 3, 4).
     */
    viewPoses(): Float32Array;
    /**
     * The candidates that were photographed, in order.
     */
    views(): Uint32Array;
    /**
     * How many views the plan asks for.
     */
    readonly budget: number;
}

/**
 * Whether a frame is sharp and well lit; one byte of luma for each pixel, row by row.
 */
export function frameQuality(luma: Uint8Array | number[], width: number, height: number): FrameQuality;

export type InitInput = RequestInfo | URL | Response | BufferSource | WebAssembly.Module;

export interface InitOutput {
    readonly memory: WebAssembly.Memory;
    readonly __wbg_boardtracker_free: (a: number, b: number) => void;
    readonly __wbg_pool_free: (a: number, b: number) => void;
    readonly __wbg_session_free: (a: number, b: number) => void;
    readonly boardtracker_calibrate: (a: number) => any;
    readonly boardtracker_setIntrinsics: (a: number, b: number, c: number, d: number) => [number, number];
    readonly boardtracker_svg: (a: number, b: number, c: number) => [number, number, number, number];
    readonly boardtracker_track: (a: number, b: number, c: number, d: number, e: number) => [number, number, number];
    readonly boardtracker_try_new: (a: any) => [number, number, number];
    readonly frameQuality: (a: number, b: number, c: number, d: number) => [number, number, number];
    readonly pool_length: (a: number) => number;
    readonly pool_poses: (a: number) => [number, number];
    readonly pool_try_new: (a: any, b: number, c: number) => [number, number, number];
    readonly session_block: (a: number, b: number) => [number, number];
    readonly session_budget: (a: number) => number;
    readonly session_finish: (a: number) => any;
    readonly session_nextView: (a: number) => any;
    readonly session_observe: (a: number, b: number, c: number, d: number) => [number, number];
    readonly session_poses: (a: number) => [number, number];
    readonly session_restore: (a: number, b: number) => [number, number, number];
    readonly session_skip: (a: number, b: number) => [number, number];
    readonly session_snapshot: (a: number) => [number, number, number, number];
    readonly session_statuses: (a: number) => [number, number];
    readonly session_tour: (a: number, b: number, c: number) => [number, number, number];
    readonly session_try_new: (a: number, b: any) => [number, number, number];
    readonly session_unblock: (a: number, b: number) => [number, number];
    readonly session_viewPoses: (a: number) => [number, number];
    readonly session_views: (a: number) => [number, number];
    readonly __wbindgen_malloc: (a: number, b: number) => number;
    readonly __wbindgen_realloc: (a: number, b: number, c: number, d: number) => number;
    readonly __wbindgen_free: (a: number, b: number, c: number) => void;
    readonly __wbindgen_exn_store: (a: number) => void;
    readonly __externref_table_alloc: () => number;
    readonly __wbindgen_externrefs: WebAssembly.Table;
    readonly __externref_table_dealloc: (a: number) => void;
    readonly __externref_drop_slice: (a: number, b: number) => void;
    readonly __wbindgen_start: () => void;
}

export type SyncInitInput = BufferSource | WebAssembly.Module;

/**
 * Instantiates the given `module`, which can either be bytes or
 * a precompiled `WebAssembly.Module`.
 *
 * @param {{ module: SyncInitInput }} module - Passing `SyncInitInput` directly is deprecated.
 *
 * @returns {InitOutput}
 */
export function initSync(module: { module: SyncInitInput } | SyncInitInput): InitOutput;

/**
 * If `module_or_path` is {RequestInfo} or {URL}, makes a request and
 * for everything else, calls `WebAssembly.instantiate` directly.
 *
 * @param {{ module_or_path: InitInput | Promise<InitInput> }} module_or_path - Passing `InitInput` directly is deprecated.
 *
 * @returns {Promise<InitOutput>}
 */
export default function __wbg_init (module_or_path?: { module_or_path: InitInput | Promise<InitInput> } | InitInput | Promise<InitInput>): Promise<InitOutput>;
