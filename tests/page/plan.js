// A whole session by photos, with all numbers as bits: the same text wherever it runs.

/** `core` is the loaded package, `bytes` a network's file. */
export function plan(core, bytes) {
  const hex = (numbers) => Array.from(new Uint32Array(Float32Array.from(numbers).buffer), (word) => word.toString(16)).join(" ");
  const model = new core.Model(bytes);
  const pool = new core.Pool({ kind: "hemisphere", minElevationRad: 0.1, maxElevationRad: 1.2 }, 60, 3);
  const session = new core.Session(pool, { scheme: "support", budget: 12, seed: 3, movementCost: 0.2 }, model);
  const lines = [];
  for (let next = session.nextView(), step = 1; next; next = session.nextView(), step += 1) {
    if (step === 4) {
      session.block(next.index);
      continue;
    }
    // A disc whose size and colours depend on the step.
    const pixels = Uint8Array.from({ length: 64 * 64 * 3 }, (_, i) => {
      const [x, y] = [Math.floor(i / 3) % 64, Math.floor(i / 192)];
      const isIn = (x - 32) ** 2 + (y - 30) ** 2 < (10 + step) ** 2;
      return isIn ? (x * y * step + 37 * (i % 3)) % 256 : 128;
    });
    session.observe(next.index, { pixels, width: 64, height: 64, format: "rgb" });
    const gains = ["coverage", "geometry", "diversity", "texture"].map((objective) => hex(session.gains(objective)));
    lines.push(`${next.index} ${next.reason} ${hex([next.gain])}`, ...gains, hex(Object.values(session.progress().scores)));
  }
  lines.push(Array.from(session.snapshot()).join(" "));
  return lines;
}
