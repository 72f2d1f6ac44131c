// The camera's picture as a video element, and its frames one by one.

import { openCamera } from "./stream.js";

export class Video {
  readonly element = document.createElement("video");

  private constructor(private stream: MediaStream) {
    Object.assign(this.element, { muted: true, playsInline: true, autoplay: true });
    this.element.setAttribute("aria-label", "The camera’s picture");
    this.element.srcObject = stream;
  }

  static async open(): Promise<Video> {
    const video = new Video(await openCamera());
    await video.element.play();
    return video;
  }

  get size(): { width: number; height: number } {
    return { width: this.element.videoWidth, height: this.element.videoHeight };
  }

  /** The next frame; null where none has come, or nobody wants it. */
  async next(isWanted: () => boolean): Promise<ImageBitmap | null> {
    await nextFrame(this.element);
    return isWanted() && this.element.readyState >= 2 ? createImageBitmap(this.element) : null;
  }

  stop(): void {
    for (const track of this.stream.getTracks()) track.stop();
    this.element.srcObject = null;
  }
}

function nextFrame(video: HTMLVideoElement): Promise<void> {
  return new Promise((resolve) => {
    // A hidden tab or a stalled camera brings no frames: look again now and then.
    const timer = setTimeout(resolve, 500);
    const done = (): void => {
      clearTimeout(timer);
      resolve();
    };
    if ("requestVideoFrameCallback" in video) video.requestVideoFrameCallback(done);
    else requestAnimationFrame(done);
  });
}
