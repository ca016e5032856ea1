/** When a hand is at rest: its states then show nothing new, and need not be drawn. */
import type { State, Vec } from "../server/protocol";
import { length, minus } from "./vectors";

/** Less is not seen: a pixel is ten times as wide, and so is a newton's thousandth. */
const ALIKE_M = 1e-5;
const ALIKE_N = 5e-3;
/** So long after the last change words that follow it have been said, and a limit that was met is named no more. */
const REST_MS = 1000;

export class Rest {
  private from: State | null = null;

  /** Whether all is as it was a while ago; states are asked for in the order in which they come. */
  lasts(state: State): boolean {
    if (!this.from || !alike(this.from, state)) this.from = state;
    return state.arrivedMs - this.from.arrivedMs > REST_MS;
  }
}

function alike(a: State, b: State): boolean {
  return (
    a.flags === b.flags && a.status === b.status && near(a.hand, b.hand, ALIKE_M) && near(a.proxy, b.proxy, ALIKE_M) &&
    near(a.force, b.force, ALIKE_N) && near(a.other, b.other, ALIKE_N)
  );
}

/** A law without a proxy has none both times. */
function near(a: Vec, b: Vec, most: number): boolean {
  return a.some(Number.isNaN) ? b.some(Number.isNaN) : length(minus(a, b)) <= most;
}
