// A dropped GLB file as an object to photograph.

import { DoubleSide, Group, type Material, Matrix4, Mesh, MeshLambertMaterial, type MeshStandardMaterial, TextureLoader } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { StageError } from "./stage.js";

/** Larger files are refused: they would not fit a phone's memory. */
const MOST_BYTES = 200e6;

/** glTF has +Y up, the planner +Z. */
export const UPRIGHT = new Matrix4().makeRotationX(Math.PI / 2);

/** Reads a GLB that holds everything itself. */
export async function readGlb(file: Blob): Promise<Group> {
  if (file.size > MOST_BYTES) throw new StageError("The model is larger than 200 MB: make it smaller first.");
  const bytes = await file.arrayBuffer();
  if (bytes.byteLength < 20 || new DataView(bytes).getUint32(0, true) !== 0x46546c67) {
    throw new StageError("This is not a GLB file. Choose a file that ends in .glb.");
  }
  const loader = new GLTFLoader();
  // The page's content policy allows no fetch of blobs; images may load them.
  loader.register((parser) => {
    parser.textureLoader = new TextureLoader(parser.options.manager);
    return { name: "images-by-element" };
  });
  let scene: Group;
  try {
    scene = (await loader.parseAsync(bytes, "")).scene;
  } catch {
    throw new StageError("The model cannot be read: it is damaged, compressed in a way this page does not know, or refers to other files.");
  }
  scene.traverse((part) => {
    if (part instanceof Mesh) part.material = matt(part.material as Material | Material[], part.geometry.hasAttribute("color"));
  });
  return new Group().add(scene);
}

/** Without surroundings to mirror, metal would be black: every surface is made matt. */
function matt(material: Material | Material[], hasColours: boolean): Material {
  const from = (Array.isArray(material) ? material[0] : material) as Partial<MeshStandardMaterial> | undefined;
  const made = new MeshLambertMaterial({ side: DoubleSide, vertexColors: hasColours });
  if (from?.color) made.color.copy(from.color);
  if (from?.map) made.map = from.map;
  if (from?.alphaTest) made.alphaTest = from.alphaTest;
  return made;
}
