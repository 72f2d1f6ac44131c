// The camera's picture of an AR frame, as pixels. The browser lends it as a texture, for the time of the
// frame's callback only; a framebuffer around that texture lets it be read.

/** W3C's raw-camera-access draft, which the DOM's types lack. */
export type RawCamera = { readonly width: number; readonly height: number };
type RawBinding = { getCameraImage(camera: RawCamera): WebGLTexture | null };
export const cameraOf = (view: XRView): RawCamera | null => (view as XRView & { camera?: RawCamera | null }).camera ?? null;

export class CameraPicture {
  private binding: RawBinding;
  private framebuffer: WebGLFramebuffer;

  constructor(session: XRSession, private gl: WebGL2RenderingContext) {
    this.binding = new XRWebGLBinding(session, gl) as unknown as RawBinding;
    this.framebuffer = gl.createFramebuffer();
  }

  /** Whether the browser has what is needed at all. */
  static isOffered(): boolean {
    return typeof XRWebGLBinding === "function" && "getCameraImage" in XRWebGLBinding.prototype;
  }

  /** The pixels, bottom row first, as WebGL has them; null where this frame has no picture. */
  read(camera: RawCamera): ImageData | null {
    const { gl } = this;
    const texture = this.binding.getCameraImage(camera);
    if (!texture) return null;
    const pixels = new ImageData(camera.width, camera.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    const isReadable = gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE;
    if (isReadable) gl.readPixels(0, 0, camera.width, camera.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels.data);
    // The texture is the browser's: nothing may hold on to it after the frame.
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, null, 0);
    return isReadable ? pixels : null;
  }
}
