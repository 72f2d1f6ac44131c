// A small GLB for tests: a pyramid with a texture inside the file.

import { smallPng } from "./zips.mjs";

export function pyramid() {
  const corners = [[0, 1.2, 0], [-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]];
  const faces = [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [1, 2, 3], [1, 3, 4]];
  const positions = Float32Array.from(corners.flat());
  const uvs = Float32Array.from(corners.flatMap(([x, , z]) => [0.5 + 0.5 * x, 0.5 + 0.5 * z]));
  const indices = Uint16Array.from(faces.flat());
  const parts = [positions, uvs, indices].map((array) => Buffer.from(array.buffer));
  parts.push(smallPng());
  const views = [];
  let length = 0;
  const padded = parts.map((part) => {
    views.push({ buffer: 0, byteOffset: length, byteLength: part.length });
    const whole = Buffer.concat([part, Buffer.alloc((4 - (part.length % 4)) % 4)]);
    length += whole.length;
    return whole;
  });
  const scene = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicFactor: 1 } }],
    textures: [{ source: 0 }],
    images: [{ bufferView: 3, mimeType: "image/png" }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 5, type: "VEC3", min: [-1, 0, -1], max: [1, 1.2, 1] },
      { bufferView: 1, componentType: 5126, count: 5, type: "VEC2" },
      { bufferView: 2, componentType: 5123, count: indices.length, type: "SCALAR" },
    ],
    bufferViews: views,
    buffers: [{ byteLength: length }],
  };
  const text = Buffer.from(JSON.stringify(scene));
  const json = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, " ")]);
  const word = (value) => {
    const bytes = Buffer.alloc(4);
    bytes.writeUInt32LE(value);
    return bytes;
  };
  const body = Buffer.concat([word(json.length), Buffer.from("JSON"), json, word(length), Buffer.from("BIN\0"), ...padded]);
  return Buffer.concat([Buffer.from("glTF"), word(2), word(12 + body.length), body]);
}
