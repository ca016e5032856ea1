/** What one act changed, as runs of pixels that were the same and are the same: taken back and done again to the bit. */
import type { Labels, Span } from "./labels";

const FIRST_RUNS = 64;

export class Patch {
  /** Of each run where it begins, how long it is, and what it was and is. */
  private told = new Uint32Array(3 * FIRST_RUNS);
  private count = 0;

  get isEmpty(): boolean {
    return this.count === 0;
  }

  /** Give pixels to a part, and keep whose they were. */
  paint({ columns, data }: Labels, spans: Iterable<Span>, label: number): void {
    for (const [row, from, to] of spans) this.put(data, row * columns + from, row * columns + to, label);
  }

  /** The same for pixels that follow one another. */
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

  /** Where runs overlap, the one that was painted last is taken back first. */
  undo(data: Uint16Array): void {
    const { told } = this;
    for (let i = 3 * (this.count - 1); i >= 0; i -= 3) data.fill(told[i + 2]! >>> 16, told[i]!, told[i]! + told[i + 1]!);
  }

  redo(data: Uint16Array): void {
    const { told } = this;
    for (let i = 0; i < 3 * this.count; i += 3) data.fill(told[i + 2]! & 0xffff, told[i]!, told[i]! + told[i + 1]!);
  }

  /** Hear of each run: how many pixels went from which part to which. */
  each(hear: (start: number, length: number, before: number, after: number) => void): void {
    const { told } = this;
    for (let i = 0; i < 3 * this.count; i += 3) hear(told[i]!, told[i + 1]!, told[i + 2]! >>> 16, told[i + 2]! & 0xffff);
  }

  /** Nothing is added any more: what it holds takes no more room than it needs. */
  close(): this {
    this.told = this.told.slice(0, 3 * this.count);
    return this;
  }

  private keep(start: number, length: number, before: number, after: number): void {
    if (3 * this.count === this.told.length) {
      const more = new Uint32Array(2 * this.told.length);
      more.set(this.told);
      this.told = more;
    }
    this.told.set([start, length, ((before << 16) | after) >>> 0], 3 * this.count++);
  }
}
