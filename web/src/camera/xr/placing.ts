// Where the object is, without a board: the photographer aims at its middle from two sides. The
// middle is the point nearest to both optical axes, so nothing is assumed of tables or distances.

import { Advice } from "../../advice.js";
import { type Pose, type Vec3, add, angleBetween, degrees, distance, dot, forward, position, radians, scale, subtract } from "../../geometry.js";

export type Aim = { eye: Vec3; towards: Vec3 };

/** Nearer directions than this do not tell how far away the object is: 2° of aim would be 10 % of it. */
const LEAST_TURN_RAD = radians(20);
/** The axes may pass so far from each other: aiming by hand, 2 cm and a share of the object's size. */
const [MISS_M, MISS_SHARE] = [0.02, 0.4];

export const aimOf = (pose: Pose): Aim => ({ eye: position(pose), towards: forward(pose) });

/** The object's middle; an `Advice` where two aims do not tell. `objectM` is the object's size. */
export function middleOf(first: Aim, second: Aim, objectM: number): Vec3 {
  const turn = angleBetween(first.towards, second.towards);
  if (turn < LEAST_TURN_RAD || turn > Math.PI - LEAST_TURN_RAD) {
    throw new Advice(
      turn < LEAST_TURN_RAD
        ? `That is ${Math.round(degrees(turn))}° from the first place. Step further round, about a quarter, and aim again.`
        : "That is straight opposite the first place. Go to a side, about a quarter round, and aim again.",
    );
  }
  // |first + s a - second - t b| is least where its derivatives by s and t vanish.
  const between = subtract(first.eye, second.eye);
  const cosine = dot(first.towards, second.towards);
  const [a, b] = [dot(first.towards, between), dot(second.towards, between)];
  const s = (cosine * b - a) / (1 - cosine * cosine);
  const t = (b - cosine * a) / (1 - cosine * cosine);
  const [p, q] = [add(first.eye, scale(first.towards, s)), add(second.eye, scale(second.towards, t))];
  if (s <= 0 || t <= 0 || distance(p, q) > MISS_M + MISS_SHARE * objectM) {
    throw new Advice("The two aims do not meet. Aim at the same spot, the object’s middle, once more.");
  }
  return scale(add(p, q), 0.5);
}
