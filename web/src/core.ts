// The words of `vantage-wasm` that the page speaks: types only, so that nothing of it loads here.

import type { NextView, Objective } from "vantage-wasm";

export type { Finish, NextView, Objective, Plan, Status, ViewSpace } from "vantage-wasm";
export type Reason = NextView["reason"];
export type Scores = Record<Objective, number>;
