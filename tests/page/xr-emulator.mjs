// A phone in AR, emulated: iwer (WebXR in JavaScript) for sessions and poses. What iwer lacks is added
// here: the camera's picture (`camera-access`), the DOM overlay's style, and tracking that gets lost.

import { createRequire } from "node:module";

const IWER = createRequire(import.meta.url).resolve("iwer/build/iwer.min.js");
/** The emulated camera's field of view from top to bottom, radians. */
export const FOV_Y_RAD = 1.1;

/** Loads the emulator into a page before anything else runs; `options.features` of the phone. */
export async function emulate(page, { features = ["viewer", "local", "dom-overlay", "camera-access"], refusal = null } = {}) {
  await page.addInitScript({ path: IWER });
  await page.addInitScript(install, { features, refusal, fovY: FOV_Y_RAD });
}

/** Moves the phone: its camera at `eye`, turned by a quaternion (x, y, z, w); returns once the page has seen it. */
export async function move(page, { eye, turn }) {
  const seen = await page.evaluate(([eye, turn]) => {
    globalThis.phone.device.position.set(...eye);
    globalThis.phone.device.quaternion.set(...turn);
    return globalThis.phone.pictures;
  }, [eye, turn]);
  // The page asks for a picture after it has judged the one before: the third is after one of the new place.
  await page.waitForFunction((count) => globalThis.phone.pictures >= count, seen + 3, { polling: 30 });
}

/** Runs in the page. */
function install({ features, refusal, fovY }) {
  const { XRDevice, metaQuest3 } = globalThis.IWER;
  const device = new XRDevice(
    { ...metaQuest3, name: "a phone", controllerConfig: undefined, supportedFeatures: features, userAgent: navigator.userAgent },
    { fovy: fovY, ipd: 0 },
  );
  device.installRuntime({ forceInstall: true });
  // Behind the page, as a phone's camera picture is.
  device.canvasContainer.style.zIndex = "-1";
  device.canvasContainer.style.background = "#8a7a66";
  device.canvasContainer.setAttribute("aria-hidden", "true"); // a real session's canvas is not in the page
  const phone = { device, session: null, isLost: false, pictures: 0 };
  globalThis.phone = phone;

  const requestSession = navigator.xr.requestSession.bind(navigator.xr);
  navigator.xr.requestSession = async (mode, options) => {
    if (refusal) throw new DOMException("", refusal);
    phone.session = await requestSession(mode, options);
    // How browsers style the overlay's root (WebXR DOM Overlays, section 4.1).
    const { root } = options.domOverlay;
    const style = { position: "fixed", inset: "0", overflow: "auto", contain: "paint", margin: "0", background: "transparent" };
    Object.assign(root.style, style);
    phone.session.addEventListener("end", () => { for (const name of Object.keys(style)) root.style[name] = ""; });
    return phone.session;
  };

  const getViewerPose = globalThis.XRFrame.prototype.getViewerPose;
  globalThis.XRFrame.prototype.getViewerPose = function (space) {
    return phone.isLost ? null : getViewerPose.call(this, space);
  };

  if (!features.includes("camera-access")) return;
  // As large as the screen.
  const camera = { width: innerWidth, height: innerHeight };
  Object.defineProperty(globalThis.XRView.prototype, "camera", { get: () => camera });
  let drawn = null;
  globalThis.XRWebGLBinding = class {
    constructor(_, gl) {
      this.gl = gl;
      this.texture = gl.createTexture();
    }
    getCameraImage() {
      const { gl } = this;
      phone.pictures += 1;
      drawn ??= draw(camera.width, camera.height);
      gl.bindTexture(gl.TEXTURE_2D, this.texture);
      // The first row of a texture is the bottom one, as of the textures that Chrome lends.
      gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, true);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, drawn);
      gl.bindTexture(gl.TEXTURE_2D, null);
      return this.texture;
    }
  };

  /** A checked ball in the middle; a red square in the upper left corner tells which way up it is. */
  function draw(width, height) {
    const canvas = new OffscreenCanvas(width, height);
    const drawing = canvas.getContext("2d");
    drawing.fillStyle = "#b9b2a4";
    drawing.fillRect(0, 0, width, height);
    drawing.save();
    drawing.beginPath();
    drawing.arc(width / 2, height / 2, 0.35 * Math.min(width, height), 0, 2 * Math.PI);
    drawing.clip();
    for (let y = 0; y < height; y += 12) {
      for (let x = 0; x < width; x += 12) {
        drawing.fillStyle = (x + y) % 24 === 0 ? "#4a3a2c" : "#c98d4f";
        drawing.fillRect(x, y, 12, 12);
      }
    }
    drawing.restore();
    drawing.fillStyle = "#ff0000";
    drawing.fillRect(0, 0, 40, 40);
    return canvas;
  }
}
