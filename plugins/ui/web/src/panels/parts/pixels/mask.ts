/** The mask of a proposed part, which brush and outline correct. */
import { union, type Box, boundingBox, EMPTY, type Labels, type Span } from "./labels";
import type { Patch } from "./patch";

/** A run-length mask within a box: the first run is outside, then they alternate. */
export interface Proposal {
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
    if (on) this.box = union(this.box, boundingBox(spans));
  }

  clear(): void {
    const { left, right, top, bottom } = this.box;
    for (let row = top; row < bottom; row++) this.data.fill(0, row * this.columns + left, row * this.columns + right);
    this.box = EMPTY;
  }

  /** Yield its pixels as spans. */
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

  /** Paint its pixels with a label. */
  accept(labels: Labels, label: number, patch: Patch): void {
    patch.paint(labels, this.spans(), label);
  }
}

export function toSpans({ box: [left, top, columns], runs }: Proposal): Span[] {
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
