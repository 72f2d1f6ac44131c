// The package as its users have it, in the build that VANTAGE_BUILD names, and small helpers.

import { readFileSync } from "node:fs";

import { load } from "../pkg/node.js";

export const vantage = await load({ build: process.env.VANTAGE_BUILD });

/** A file of the repository, or of the folder that `same-plan` wrote its inputs to. */
export const file = (name) => readFileSync(new URL(`../../${name}`, import.meta.url));
export const input = (name) => readFileSync(`${process.env.VANTAGE_INPUTS}/${name}`);

const { Model, Pool, Session } = vantage;

/** The networks that come with the package. */
export const seeing = new Model(file("wasm/pkg/soarnet.model"));
export const poseNetwork = new Model(file("wasm/pkg/soarnet-poses.model"));

export const pool = (count = 40) => new Pool({ kind: "fibonacci-sphere" }, count, 3);

/** A session whose network looks at poses alone, after so many photos. */
export function session(plan = {}, photos = 0) {
  const begun = new Session(pool(), { scheme: "ensemble", budget: 12, ...plan }, poseNetwork);
  for (let photo = 0; photo < photos; photo++) begun.observe(begun.nextView().index);
  return begun;
}

/** The number of a plan's remaining views, in order. */
export function rest(session) {
  const taken = [];
  for (let next = session.nextView(); next; next = session.nextView()) {
    session.observe(next.index);
    taken.push(next.index);
  }
  return taken;
}

/** What a call throws. */
export function thrown(call) {
  try {
    call();
  } catch (error) {
    return error;
  }
  return undefined;
}
