// Renders the object of a simulated capture: photos, face ids, and what the page shows.

import {
  AmbientLight, BufferAttribute, BufferGeometry, DirectionalLight, DoubleSide, GLSL3, Group, HemisphereLight, Material, Matrix4,
  Mesh, MeshLambertMaterial, NearestFilter, OrthographicCamera, PerspectiveCamera, RawShaderMaterial, Scene, Vector3,
  WebGLRenderTarget, WebGLRenderer,
} from "three";
import { Advice } from "../advice.js";
import { type Pose, degrees } from "../geometry.js";
import { DISTANCE, FOV_X_RAD } from "../layout.js";

/** Side of the photos that are taken, pixels. */
export const PHOTO = 512;
/** Side of the images of face ids, pixels. */
const IDS = 256;
/** More faces than the ids of three bytes can number, or than a phone renders, are refused. */
const MOST_FACES = 1_000_000;

export class StageError extends Advice {}

export class Stage {
  private renderer: WebGLRenderer;
  private scene = new Scene();
  private idScene = new Scene();
  private camera = new PerspectiveCamera(degrees(FOV_X_RAD), 1, 0.5, 20);
  private side = new OrthographicCamera(-1, 1, 1, -1, 0.1, 20);
  private target = new WebGLRenderTarget(IDS, IDS, { minFilter: NearestFilter, magFilter: NearestFilter });
  /** The triangles, shape (faces, 3, 3), in the planner's coordinates: in the unit sphere. */
  triangles: Float32Array = new Float32Array();

  constructor() {
    try {
      this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    } catch {
      throw new StageError("This browser cannot draw in three dimensions (WebGL 2 is missing or switched off).");
    }
    this.renderer.setPixelRatio(1);
    this.renderer.setClearColor(0, 0);
    this.camera.matrixAutoUpdate = false;
    // The light tent of the renders that the network learned from (lab/src/render/shade.rs).
    const sky = new HemisphereLight(0xffffff, 0xffffff, 0.25 * Math.PI);
    sky.groundColor.setScalar(0);
    sky.position.set(0, 0, 1);
    const lamp = new DirectionalLight(0xffffff, 0.3 * Math.PI);
    lamp.position.set(0.36, -0.48, 0.8);
    this.scene.add(new AmbientLight(0xffffff, 0.45 * Math.PI), sky, lamp);
  }

  /** Puts an object in, scaled into the unit sphere; `turn` takes its axes to +Z up. */
  setObject(object: Group, turn: Matrix4 = new Matrix4()): void {
    object.applyMatrix4(turn);
    object.updateMatrixWorld(true);
    const triangles = trianglesOf(object);
    const fit = fitting(triangles);
    object.applyMatrix4(fit);
    object.updateMatrixWorld(true);
    this.triangles = trianglesOf(object);
    this.scene.add(object);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(this.triangles, 3));
    const ids = new Mesh(geometry, idMaterial());
    ids.frustumCulled = false;
    this.idScene.add(ids);
  }

  /** The photo from a pose: RGBA on transparent ground. */
  async photo(pose: Pose): Promise<ImageBitmap> {
    this.render(pose, PHOTO);
    return createImageBitmap(this.renderer.domElement);
  }

  /** Face number + 1 of each pixel, 0 where there is nothing; shape (256, 256), top row first. */
  async faces(pose: Pose): Promise<Uint32Array> {
    this.look(pose);
    this.renderer.setRenderTarget(this.target);
    this.renderer.clear();
    this.renderer.render(this.idScene, this.camera);
    this.renderer.setRenderTarget(null);
    const bytes = new Uint8Array(4 * IDS * IDS);
    await this.renderer.readRenderTargetPixelsAsync(this.target, 0, 0, IDS, IDS, bytes);
    const ids = new Uint32Array(IDS * IDS);
    for (let y = 0; y < IDS; y += 1) {
      for (let x = 0; x < IDS; x += 1) {
        const at = 4 * ((IDS - 1 - y) * IDS + x);
        ids[y * IDS + x] = (bytes[at] ?? 0) | ((bytes[at + 1] ?? 0) << 8) | ((bytes[at + 2] ?? 0) << 16);
      }
    }
    return ids;
  }

  /** Shows what the camera at a pose sees. */
  show(canvas: HTMLCanvasElement, pose: Pose): void {
    this.render(pose, canvas.width);
    this.copy(canvas);
  }

  /** Shows the object small in the middle of the dome, whose rim is the picture's, from a side. */
  showInDome(canvas: HTMLCanvasElement, azimuthRad: number, elevationRad: number, rim: number): void {
    const reach = DISTANCE * rim;
    Object.assign(this.side, { left: -reach, right: reach, top: reach, bottom: -reach });
    this.side.up.set(0, 0, 1);
    const flat = 10 * Math.cos(elevationRad);
    this.side.position.set(flat * Math.cos(azimuthRad), flat * Math.sin(azimuthRad), 10 * Math.sin(elevationRad));
    this.side.lookAt(0, 0, 0);
    this.side.updateProjectionMatrix();
    this.renderer.setSize(canvas.width, canvas.width, false);
    this.renderer.render(this.scene, this.side);
    this.copy(canvas);
  }

  dispose(): void {
    this.target.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private render(pose: Pose, size: number): void {
    this.look(pose);
    this.renderer.setSize(size, size, false);
    this.renderer.render(this.scene, this.camera);
  }

  private look(pose: Pose): void {
    const at = (i: number): number => pose[i] ?? 0;
    this.camera.matrix.set(
      at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9), at(10), at(11), 0, 0, 0, 1,
    );
    this.camera.updateMatrixWorld(true);
  }

  private copy(canvas: HTMLCanvasElement): void {
    const drawing = canvas.getContext("2d");
    drawing?.clearRect(0, 0, canvas.width, canvas.height);
    drawing?.drawImage(this.renderer.domElement, 0, 0, canvas.width, canvas.height);
  }
}

/** The built-in object. */
export async function builtIn(): Promise<Group> {
  const { steamEngine } = await import("./engine-model.js");
  return new Group().add(new Mesh(steamEngine(), new MeshLambertMaterial({ vertexColors: true, side: DoubleSide })));
}

function idMaterial(): Material {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    side: DoubleSide,
    vertexShader: `
      precision highp float;
      uniform mat4 modelViewMatrix, projectionMatrix;
      in vec3 position;
      flat out vec3 id;
      void main() {
        int n = gl_VertexID / 3 + 1;
        id = vec3(n & 255, (n >> 8) & 255, (n >> 16) & 255) / 255.0;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: `
      precision highp float;
      flat in vec3 id;
      out vec4 colour;
      void main() { colour = vec4(id, 1.0); }`,
  });
}

function trianglesOf(object: Group): Float32Array {
  const all: number[] = [];
  const point = new Vector3();
  object.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    const geometry = part.geometry as BufferGeometry;
    const place = geometry.getAttribute("position");
    const index = geometry.index;
    const count = index ? index.count : place.count;
    if (all.length / 9 + count / 3 > MOST_FACES) {
      throw new StageError(`The model has more than ${MOST_FACES.toLocaleString("en")} triangles: make it simpler first.`);
    }
    for (let i = 0; i < count - (count % 3); i += 1) {
      part.getVertexPosition(index ? index.getX(i) : i, point).applyMatrix4(part.matrixWorld);
      all.push(point.x, point.y, point.z);
    }
  });
  if (all.length === 0) throw new StageError("The model has no triangles.");
  if (!all.every(Number.isFinite)) throw new StageError("The model has corners that are no numbers.");
  return Float32Array.from(all);
}

/** Takes the box's middle to the origin and the farthest corner onto the unit sphere. */
function fitting(triangles: Float32Array): Matrix4 {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  triangles.forEach((value, i) => {
    low[i % 3] = Math.min(low[i % 3] ?? 0, value);
    high[i % 3] = Math.max(high[i % 3] ?? 0, value);
  });
  const middle = low.map((value, axis) => 0.5 * (value + (high[axis] ?? 0))) as [number, number, number];
  let reach = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const out = middle.map((value, axis) => (triangles[i + axis] ?? 0) - value);
    reach = Math.max(reach, Math.hypot(...out));
  }
  if (!(reach > 0)) throw new StageError("The model has no size.");
  const scale = 1 / (reach * 1.0001);
  return new Matrix4().makeScale(scale, scale, scale).multiply(new Matrix4().makeTranslation(-middle[0], -middle[1], -middle[2]));
}
