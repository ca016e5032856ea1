/** What was proposed and is not a part yet: pixels that a brush adds to and takes away from. */
import { around, type Box, boxOf, EMPTY, type Labels, type Span } from "./labels";
import type { Patch } from "./patch";

/** A mask within a box, as runs from its first row on: the first is outside, then they take turns. */
export interface Proposed {
  box: [x: number, y: number, columns: number, rows: number];
  runs: number[];
}

export class Mask {
  readonly data: Uint8Array;
  box: Box = EMPTY;

  constructor(
    readonly columns: number,
    readonly rows: number,
  ) {
    this.data = new Uint8Array(columns * rows);
  }

  put(spans: Span[], on: boolean): void {
    for (const [row, from, to] of spans) this.data.fill(+on, row * this.columns + from, row * this.columns + to);
    if (on) this.box = around(this.box, boxOf(spans));
  }

  clear(): void {
    const { left, right, top, bottom } = this.box;
    for (let row = top; row < bottom; row++) this.data.fill(0, row * this.columns + left, row * this.columns + right);
    this.box = EMPTY;
  }

  /** Its pixels, as spans of rows. */
  *spans(): Generator<Span> {
    const { data, columns } = this;
    const { left, right, top, bottom } = this.box;
    for (let row = top; row < bottom; row++) {
      for (let x = left; x < right; ) {
        const from = x;
        const on = data[row * columns + x];
        while (x < right && data[row * columns + x] === on) x++;
        if (on) yield [row, from, x];
      }
    }
  }

  /** Make them a part. */
  accept(labels: Labels, label: number, patch: Patch): void {
    patch.paint(labels, this.spans(), label);
  }
}

export function spansOf({ box: [left, top, columns], runs }: Proposed): Span[] {
  const spans: Span[] = [];
  let at = 0;
  runs.forEach((length, i) => {
    const end = at + length;
    while (at < end) {
      const to = Math.min(end, at - (at % columns) + columns);
      if (i % 2) spans.push([top + Math.floor(at / columns), left + (at % columns), left + (at % columns) + to - at]);
      at = to;
    }
  });
  return spans;
}
