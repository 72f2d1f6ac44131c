// Where the object of a capture stands, from its cameras alone: vectors of three numbers, poses as
// `transform_matrix` of transforms.json (world from camera, OpenGL axes).
//
// `cargo vantage plan --photos` does this more carefully: it forgives photos of something else, lenses
// that differ, and cameras held on their side.

export const add = (a, b) => a.map((value, axis) => value + b[axis]);
export const scale = (a, factor) => a.map((value) => value * factor);
export const subtract = (a, b) => add(a, scale(b, -1));
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [0, 1, 2].map((axis) => {
  const [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
  return a[next] * b[last] - a[last] * b[next];
});
export const length = (a) => Math.hypot(...a);
export const unit = (a) => scale(a, 1 / length(a));

export const position = (matrix) => [0, 1, 2].map((row) => matrix[row][3]);
const column = (matrix, axis) => [0, 1, 2].map((row) => matrix[row][axis]);
const forward = (matrix) => scale(column(matrix, 2), -1);

/** The object's middle (the point nearest to all optical axes), the upward direction (the mean of the
 *  cameras'), and the radius of the sphere that half of the photos could show whole. */
export function layoutOf(frames) {
  const rows = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  let right = [0, 0, 0];
  for (const { matrix } of frames) {
    // Σ (I - d dᵀ) (centre - eye) = 0
    const axis = forward(matrix);
    const across = (vector) => subtract(vector, scale(axis, dot(axis, vector)));
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((one, row) => (rows[row] = add(rows[row], across(one))));
    right = add(right, across(position(matrix)));
  }
  const [a, b, c] = rows;
  const determinant = dot(a, cross(b, c));
  if (!(determinant > 1e-4 * frames.length ** 3)) {
    throw new Error("the photos look all in one direction: take some from another side first");
  }
  const centre = [cross(b, c), cross(c, a), cross(a, b)]
    .map((cofactors, row) => scale(cofactors, right[row] / determinant))
    .reduce(add);
  const up = unit(frames.map(({ matrix }) => column(matrix, 1)).reduce(add));
  const framed = frames.map(({ matrix, lens }) => {
    const half = Math.min(lens.width, lens.height) / 2;
    return (length(subtract(position(matrix), centre)) * half) / Math.hypot(lens.focal, half);
  });
  return { centre, up, radius: median(framed) };
}

export const median = (values) => values.toSorted((a, b) => a - b)[values.length >> 1];

/** Turns vectors so that `up` becomes +Z, which is what the planner takes for up; and back. */
export function levelling(up) {
  const aside = unit(cross(up, Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
  const axes = [aside, cross(up, aside), up];
  return {
    level: (vector) => axes.map((axis) => dot(axis, vector)),
    restore: (vector) => axes.map((axis, row) => scale(axis, vector[row])).reduce(add),
  };
}

/** The rows of a camera at `eye` that looks at the origin with its top towards +Z, 12 numbers. */
export function lookingAtOrigin(eye) {
  const back = unit(eye);
  const right = unit(cross([0, 0, 1], back));
  const up = cross(back, right);
  return Float32Array.from([0, 1, 2].flatMap((row) => [right[row], up[row], back[row], eye[row]]));
}

/** The square of a photo that shows the object as large as the network knows it: from three times its
 *  radius, in a picture 0.69 rad wide. */
export function windowOf({ matrix, lens }, { centre, radius }) {
  const ray = subtract(centre, position(matrix));
  const [x, y, z] = [0, 1, 2].map((axis) => dot(column(matrix, axis), ray));
  if (z >= 0) return undefined; // it looks away from the object
  const side = Math.round((2 * lens.focal * 3 * radius * Math.tan(0.345556)) / length(ray));
  const corner = (middle, toward) => Math.round(middle + (lens.focal * toward) / -z - side / 2);
  return { left: corner(lens.cx, x), top: corner(lens.cy, -y), side };
}

export const degrees = (radians) => (radians * 180) / Math.PI;
export const angle = (a, b) => Math.acos(Math.min(1, Math.max(-1, dot(unit(a), unit(b)))));
export const elevation = (direction) => Math.asin(unit(direction)[2]);
