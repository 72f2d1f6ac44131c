import { describe, expect, it } from "vitest";
import { checkRecord } from "../src/record.js";
import { Journal } from "../src/worker/journal.js";
import { Memory } from "../src/worker/store.js";
import { record } from "./record.js";

describe("the journal", () => {
  it("gives back the last entry", async () => {
    const store = new Memory();
    const journal = new Journal(store);
    for (const name of ["one", "two", "three"]) await journal.write({ record: record(name), snapshot: Uint8Array.of(0, 255, 7) });
    const entry = await new Journal(store).read();
    expect(entry?.record.name).toBe("three");
    expect([...(entry?.snapshot ?? [])]).toEqual([0, 255, 7]);
  });

  it("survives a write that broke off: the entry before is whole", async () => {
    const store = new Memory();
    const journal = new Journal(store);
    for (const name of ["one", "two"]) await journal.write({ record: record(name), snapshot: new Uint8Array() });
    const latest = (await store.get("journal-a")) ?? new Blob();
    await store.put("journal-a", new Uint8Array(await latest.slice(0, latest.size - 9).arrayBuffer()));
    const again = new Journal(store);
    expect((await again.read())?.record.name).toBe("one");
    // And goes on without writing over the whole one.
    await again.write({ record: record("three"), snapshot: new Uint8Array() });
    expect((await new Journal(store).read())?.record.name).toBe("three");
  });

  it("does not believe an entry of which a letter has changed", async () => {
    const store = new Memory();
    await new Journal(store).write({ record: record("mine"), snapshot: new Uint8Array() });
    const text = await ((await store.get("journal-b")) ?? new Blob()).text();
    await store.put("journal-b", new TextEncoder().encode(text.replace("mine", "mint")));
    expect(await new Journal(store).read()).toBeNull();
  });

  it("is empty where nothing was written", async () => {
    expect(await new Journal(new Memory()).read()).toBeNull();
  });
});

describe("records from outside", () => {
  it("pass as they were written", () => {
    const value: unknown = JSON.parse(JSON.stringify(record("mine")));
    expect(checkRecord(value)).toEqual(record("mine"));
  });

  it.each([
    [null, "not a capture"],
    [{ format: "other" }, "not a capture"],
    [{ ...record("a"), version: 9 }, "another version"],
    [{ ...record("a"), photos: [{ pose: [1, 2] }] }, "damaged"],
    [{ ...record("a"), lens: undefined }, "damaged"],
  ])("are refused in words: %#", (value, words) => expect(() => checkRecord(value)).toThrow(words));
});
