// The poses of a plan in the form of `transforms.json` (Instant-NGP, Nerfstudio): OpenGL camera
// axes, +Z up, `transform_matrix` = world_from_camera. The camera's own numbers are left out,
// because no photo has been taken yet: whoever takes them adds intrinsics and pictures.

export type Frame = { file_path: string; transform_matrix: number[][] };
export type Transforms = { frames: Frame[] };

/** One frame for each pose, shape (count, 3, 4), in the order of the photos. */
export function transforms(poses: Float32Array): Transforms {
  const frames: Frame[] = [];
  for (let start = 0; start + 12 <= poses.length; start += 12) {
    const row = (r: number): number[] => [...poses.subarray(start + 4 * r, start + 4 * r + 4)];
    frames.push({
      file_path: `images/${String(frames.length + 1).padStart(4, "0")}.jpg`,
      transform_matrix: [row(0), row(1), row(2), [0, 0, 0, 1]],
    });
  }
  return { frames };
}
