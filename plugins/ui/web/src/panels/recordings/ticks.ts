/** A recording: a row per tick, as the core's TICK_COLUMNS, each convertible to a state. */
import { FLAGS, now, type State, type Vec } from "kit/server/protocol";

export const COLUMNS = 17;
const AT = { time: 0, late: 1, hand: 2, velocity: 5, proxy: 8, force: 11, flags: 14, buttons: 15 } as const;

export class Ticks {
  readonly count: number;

  constructor(private rows: Float32Array) {
    this.count = Math.floor(rows.length / COLUMNS);
  }

  get seconds(): number {
    return this.count ? this.time(this.count - 1) - this.time(0) : 0;
  }

  time(i: number): number {
    return this.rows[i * COLUMNS + AT.time]!;
  }

  force(i: number): number {
    return Math.hypot(...this.vector(i, AT.force));
  }

  /** Return the last tick that began by then; 0 before the first. */
  at(seconds: number): number {
    let [low, high] = [0, this.count - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time(middle) <= seconds) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  state(i: number): State {
    const hand = this.vector(i, AT.hand);
    return {
      status: 0,
      flags: this.rows[i * COLUMNS + AT.flags]! & ~FLAGS.OVERRUN,
      seq: i,
      tag: 0,
      overruns: 0,
      sampleMs: now(),
      hand,
      proxy: this.vector(i, AT.proxy),
      force: this.vector(i, AT.force),
      velocity: this.vector(i, AT.velocity),
      other: [0, 0, 0],
      lateUs: 1e6 * this.rows[i * COLUMNS + AT.late]!,
      arrivedMs: now(),
    };
  }

  /** Return the strongest force in each of equal spans of time, newtons. */
  outline(spans: number): Float32Array {
    const most = new Float32Array(spans);
    const [from, span] = [this.count ? this.time(0) : 0, this.seconds / spans || 1];
    for (let i = 0; i < this.count; i++) {
      const k = Math.min(spans - 1, Math.floor((this.time(i) - from) / span));
      most[k] = Math.max(most[k]!, this.force(i));
    }
    return most;
  }

  private vector(i: number, from: number): Vec {
    const k = i * COLUMNS + from;
    return [this.rows[k]!, this.rows[k + 1]!, this.rows[k + 2]!];
  }
}
