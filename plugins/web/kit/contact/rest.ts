/** A hand at rest: its states show nothing new, and need not be drawn. */
import type { State, Vec } from "../server/protocol";
import { length, minus } from "./vectors";

/** Differences too small to see: a tenth of a pixel, and of an arrow. */
const ALIKE_M = 1e-5;
const ALIKE_N = 5e-3;
/** Milliseconds after the last change at which dependent texts are up to date and limits no longer named. */
const REST_MS = 1000;

export class Rest {
  private from: State | null = null;

  /** Return whether nothing has changed for a while; states are passed in order. */
  isAtRest(state: State): boolean {
    if (!this.from || !areAlike(this.from, state)) this.from = state;
    return state.arrivedMs - this.from.arrivedMs > REST_MS;
  }
}

function areAlike(a: State, b: State): boolean {
  return (
    a.flags === b.flags && a.status === b.status && areNear(a.hand, b.hand, ALIKE_M) && areNear(a.proxy, b.proxy, ALIKE_M) &&
    areNear(a.force, b.force, ALIKE_N) && areNear(a.other, b.other, ALIKE_N)
  );
}

/** Return whether two vectors are near, or both NaN, as for a law without a proxy. */
function areNear(a: Vec, b: Vec, most: number): boolean {
  return a.some(Number.isNaN) ? b.some(Number.isNaN) : length(minus(a, b)) <= most;
}
