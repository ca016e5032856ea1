/** Change of labels as runs of pixels, undone and redone exactly. */
import type { Labels, Span } from "./labels";

const FIRST_RUNS = 64;

export class Patch {
  /** Start, length, and old and new label (16 bits each) of every run. */
  private runs = new Uint32Array(3 * FIRST_RUNS);
  private count = 0;

  get isEmpty(): boolean {
    return this.count === 0;
  }

  /** Paint spans with a label and record the old ones. */
  paint({ columns, data }: Labels, spans: Iterable<Span>, label: number): void {
    for (const [row, from, to] of spans) this.put(data, row * columns + from, row * columns + to, label);
  }

  /** Paint consecutive pixels with a label and record the old ones. */
  put(data: Uint16Array, start: number, end: number, label: number): void {
    let from = start;
    while (from < end) {
      const before = data[from]!;
      let to = from + 1;
      while (to < end && data[to] === before) to++;
      if (before !== label) this.keep(from, to - from, before, label);
      from = to;
    }
    data.fill(label, start, end);
  }

  /** Restore the old labels, the last run first. */
  undo(data: Uint16Array): void {
    const { runs: told } = this;
    for (let i = 3 * (this.count - 1); i >= 0; i -= 3) data.fill(told[i + 2]! >>> 16, told[i]!, told[i]! + told[i + 1]!);
  }

  redo(data: Uint16Array): void {
    const { runs: told } = this;
    for (let i = 0; i < 3 * this.count; i += 3) data.fill(told[i + 2]! & 0xffff, told[i]!, told[i]! + told[i + 1]!);
  }

  /** Call a function with each run: start, length, old and new label. */
  each(hear: (start: number, length: number, before: number, after: number) => void): void {
    const { runs: told } = this;
    for (let i = 0; i < 3 * this.count; i += 3) hear(told[i]!, told[i + 1]!, told[i + 2]! >>> 16, told[i + 2]! & 0xffff);
  }

  /** Trim the buffer after the last run. */
  close(): this {
    this.runs = this.runs.slice(0, 3 * this.count);
    return this;
  }

  private keep(start: number, length: number, before: number, after: number): void {
    if (3 * this.count === this.runs.length) {
      const more = new Uint32Array(2 * this.runs.length);
      more.set(this.runs);
      this.runs = more;
    }
    this.runs.set([start, length, ((before << 16) | after) >>> 0], 3 * this.count++);
  }
}
