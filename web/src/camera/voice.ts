// Guidance aloud, for those who look at the object and not at the screen.

/** The same sentence is not repeated sooner, milliseconds. */
const REPEAT_MS = 7000;
/** Between different sentences, so that they can be followed. */
const PAUSE_MS = 2500;

export class Voice {
  private last = { text: "", at: Number.NEGATIVE_INFINITY };

  /** Says a sentence unless it was just said; what is urgent interrupts. */
  say(text: string, isUrgent: boolean, now = performance.now()): void {
    if (!isDue(this.last, text, isUrgent, now)) return;
    this.last = { text, at: now };
    const speech = globalThis.speechSynthesis;
    if (!speech) return;
    speech.cancel();
    const words = new SpeechSynthesisUtterance(text);
    words.lang = "en";
    speech.speak(words);
  }

  silence(): void {
    globalThis.speechSynthesis?.cancel();
  }
}

export function isDue(last: { text: string; at: number }, text: string, isUrgent: boolean, now: number): boolean {
  if (text === "") return false;
  const since = now - last.at;
  if (text === last.text) return since >= REPEAT_MS;
  return since >= (isUrgent ? PAUSE_MS / 2 : PAUSE_MS);
}
