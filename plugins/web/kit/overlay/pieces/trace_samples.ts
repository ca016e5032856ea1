/** Ring buffer of the contact's positions in the last seconds, allocated once. */

/** Numbers per sample: x, y, z, newtons, seconds, 1 if it continues the previous sample, and two that fill two texels. */
export const STRIDE = 8;
const NEWTONS = 3;
const SECONDS = 4;
const JOINED = 5;

export class TraceSamples {
  /** Slots, followed by a copy of the first one: a line from each slot to the next is then a plain pair. */
  readonly data: Float32Array;
  /** Number of samples added so far. */
  added = 0;
  private lifted = true;

  constructor(readonly slots: number) {
    this.data = new Float32Array((slots + 1) * STRIDE);
  }

  /** Slot of the newest sample. */
  get newest(): number {
    return (this.added + this.slots - 1) % this.slots;
  }

  /** Return the number of samples since a time, the newest included. */
  since(seconds: number): number {
    const most = Math.min(this.added, this.slots);
    let found = 0;
    while (found < most && this.data[((this.added - 1 - found) % this.slots) * STRIDE + SECONDS] >= seconds) found++;
    return found;
  }

  add(x: number, y: number, z: number, newtons: number, seconds: number): void {
    const slot = this.added % this.slots;
    this.put(slot, x, y, z, newtons, seconds);
    if (slot === 0) this.put(this.slots, x, y, z, newtons, seconds);
    this.lifted = false;
    this.added++;
  }

  /** Start another line with the next sample. */
  lift(): void {
    this.lifted = true;
  }

  clear(): void {
    this.data.fill(0);
    this.added = 0;
    this.lifted = true;
  }

  /** Return whether a line leads from this slot to the next: it is younger, and of the same stroke. */
  joins(slot: number, sinceS: number): boolean {
    const from = slot * STRIDE;
    const to = from + STRIDE;
    return this.data[to + JOINED] === 1 && this.data[to + SECONDS] > this.data[from + SECONDS] && this.data[from + SECONDS] >= sinceS;
  }

  private put(slot: number, x: number, y: number, z: number, newtons: number, seconds: number): void {
    const at = slot * STRIDE;
    this.data[at] = x;
    this.data[at + 1] = y;
    this.data[at + 2] = z;
    this.data[at + NEWTONS] = newtons;
    this.data[at + SECONDS] = seconds;
    this.data[at + JOINED] = this.lifted ? 0 : 1;
  }
}
