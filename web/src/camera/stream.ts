// The camera's picture, or a sentence that says why there is none.

import { Advice } from "../advice.js";

export async function openCamera(): Promise<MediaStream> {
  if (!navigator.mediaDevices?.getUserMedia) {
    throw new Advice(
      isSecureContext
        ? "This browser gives pages no camera. Use a current Chrome, Firefox or Safari."
        : "The camera needs a secure address: open this page by https, or on the computer itself by localhost.",
    );
  }
  try {
    return await navigator.mediaDevices.getUserMedia({
      audio: false,
      video: { facingMode: { ideal: "environment" }, width: { ideal: 1920 }, height: { ideal: 1080 } },
    });
  } catch (error) {
    throw new Advice(cameraWords(error instanceof DOMException ? error.name : ""));
  }
}

/** What went wrong, by the name of the browser's error. */
export function cameraWords(name: string): string {
  switch (name) {
    case "NotAllowedError":
    case "SecurityError":
      return "The camera was refused. Allow it for this page (the icon beside the address), then start again.";
    case "NotFoundError":
    case "OverconstrainedError":
      return "There is no camera on this device. Open this page on a phone, or try the toy engine.";
    case "NotReadableError":
    case "AbortError":
      return "The camera is in use by another program. Close that, then start again.";
    default:
      return "The camera could not be started. Reload the page and try again.";
  }
}
