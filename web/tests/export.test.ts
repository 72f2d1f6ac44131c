import { describe, expect, it } from "vitest";
import { folderName, fileNames } from "../src/worker/export.js";
import { colmap, readme, transforms } from "../src/worker/files.js";
import { lookingAt } from "../src/geometry.js";
import { LEAST_POINTS, type Point, pack, padded, ply, seen, unpack } from "../src/worker/points.js";
import { sizeOf } from "../src/worker/pictures.js";
import * as zip from "../src/worker/zip.js";
import { record } from "./record.js";
import { lensOf } from "../src/geometry.js";

async function* parts(...list: zip.Part[]): AsyncIterable<zip.Part> {
  yield* list;
}

describe("zips", () => {
  it("give back what was put in", async () => {
    const blob = await zip.write(parts({ path: "a/b.txt", content: Uint8Array.of(1, 2, 3) }, { path: "a/c.bin", content: new Blob(["hi"]) }));
    const files = await zip.open(blob);
    expect(files.map(({ path }) => path)).toEqual(["a/b.txt", "a/c.bin"]);
    expect([...((await files[0]?.read()) ?? [])]).toEqual([1, 2, 3]);
  });

  it("tell when a byte has changed or the end is missing", async () => {
    const blob = await zip.write(parts({ path: "a.bin", content: new Uint8Array(1000).fill(7) }));
    const bytes = new Uint8Array(await blob.arrayBuffer());
    bytes[500] = 8;
    const [file] = await zip.open(new Blob([bytes]));
    await expect(file?.read()).rejects.toThrow();
    await expect(zip.open(blob.slice(0, 600))).rejects.toThrow();
    await expect(zip.open(new Blob(["no zip at all"]))).rejects.toThrow();
  });
});

describe("the folder's files", () => {
  const pose = [...lookingAt([3, 0, 1], [0, 0, 0])];
  const photo = { bytes: 1, takenAt: "", candidate: 0, pose, source: "simulated" as const, focalPx: 1, scores: null, gain: null, reason: "coverage" as const };
  const mine = { ...record("My mug!"), photos: [{ ...photo, number: 2, file: "frame_00002.png" }, { ...photo, number: 5, file: "frame_00005.jpg" }] };

  it("are numbered without gaps and named for every shell", () => {
    expect(fileNames(mine)).toEqual(["frame_00001.png", "frame_00002.jpg"]);
    expect(folderName(mine.name)).toBe("my-mug");
    expect(folderName("…")).toBe("capture");
  });

  it("have no key that instant-ngp would take for a scene, but for transforms.json", () => {
    const forbidden = ["frames", "aabb", "aabb_scale", "scale", "offset", "up", "render_aabb"];
    expect(Object.keys(mine).filter((key) => forbidden.includes(key))).toEqual([]);
    expect(transforms(mine, fileNames(mine), [])).toHaveProperty("frames");
  });

  it("say the same in COLMAP's text and binary", () => {
    const files = new Map(colmap(mine, fileNames(mine), padded([], [0, 0, 0], 1)));
    const text = new TextDecoder().decode(files.get("images.txt"));
    const binary = files.get("images.bin") ?? new Uint8Array();
    const view = new DataView(binary.buffer);
    expect(Number(view.getBigUint64(0, true))).toBe(2);
    const line = text.split("\n")[2]?.split(" ").map(Number) ?? [];
    for (let i = 0; i < 7; i += 1) expect(view.getFloat64(12 + 8 * i, true)).toBe(line[1 + i]);
    expect(files.get("cameras.bin")?.length).toBe(8 + 4 + 4 + 16 + 32);
  });

  it("name the command of every trainer, and warn of poses that are guesses", () => {
    for (const command of ["ns-train", "brush_app", "simple_trainer.py", "train.py -s", "instant-ngp", "colmap gui"]) {
      expect(readme(mine)).toContain(command);
    }
    expect(readme(mine)).not.toContain("guesses");
    expect(readme({ ...mine, photos: [{ ...photo, number: 1, file: "a.jpg", source: "orientation" }] })).toContain("guesses");
  });
});

describe("points", () => {
  it("lie on the plane that the photo shows, in its colours", () => {
    // One large face at z = 0.5, seen from above.
    const triangles = Float32Array.of(-9, -9, 0.5, 9, -9, 0.5, 0, 9, 0.5);
    const lens = lensOf(16, 16, 0.3);
    const photo = { data: new Uint8ClampedArray(16 * 16 * 4).fill(9), width: 16, height: 16 };
    const found = seen(lookingAt([0.2, 0.1, 3], [0, 0, 0.5]), lens, new Uint32Array(256).fill(1), triangles, photo, 64);
    expect(found).toHaveLength(64);
    for (const { position, colour } of found) {
      expect(position[2]).toBeCloseTo(0.5, 5);
      expect(colour).toEqual([9, 9, 9]);
    }
    expect(unpack(pack(found).buffer as ArrayBuffer)).toHaveLength(64);
  });

  it("are filled up to what trainers need, inside the object's sphere", () => {
    const filled = padded([], [1, 2, 3], 0.5);
    expect(filled).toHaveLength(LEAST_POINTS);
    for (const { position: [x, y, z] } of filled) expect(Math.hypot(x - 1, y - 2, z - 3)).toBeLessThanOrEqual(0.5);
    const many: Point[] = Array.from({ length: 150 }, () => ({ position: [0, 0, 0], colour: [1, 2, 3] }));
    expect(padded(many, [0, 0, 0], 1)).toHaveLength(150);
    expect(ply(many).length).toBe(ply([]).length + 2 + 15 * 150);
  });
});

it("sizes are told by the first bytes of PNG and JPEG alone", () => {
  const png = Uint8Array.of(0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10, 0, 0, 0, 13, 0x49, 0x48, 0x44, 0x52, 0, 0, 2, 0, 0, 0, 1, 0);
  expect(sizeOf(png)).toEqual({ width: 512, height: 256 });
  const jpeg = Uint8Array.of(0xff, 0xd8, 0xff, 0xe0, 0, 4, 1, 1, 0xff, 0xc0, 0, 11, 8, 0, 48, 0, 64, 1, 1, 0x11, 0, 0);
  expect(sizeOf(jpeg)).toEqual({ width: 64, height: 48 });
  expect(sizeOf(new TextEncoder().encode("GIF89a not one of ours......"))).toBeNull();
  expect(sizeOf(new Uint8Array())).toBeNull();
});
