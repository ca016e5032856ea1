/** Heights on a grid of equal cells, at the cells' centres; bilinear between, constant to the rim, as in force laws. */
import type { Vec } from "../server/protocol";

/** Place of a grid: its left and far rim, and the width and length of a cell, metres. */
export interface Place {
  left: number;
  far: number;
  dx: number;
  dy: number;
}

/** Distance a ray is moved beyond a border, in cells, so that it is surely in the next one. */
const BEYOND = 1e-7;
const BLOCK = 8;

/** Greatest heights over blocks of BLOCK^level x BLOCK^level squares; a square lies between four centres. */
interface PyramidLevel {
  size: number;
  columns: number;
  top: Float32Array;
}

export class Grid {
  private tops: PyramidLevel[] | null = null;

  constructor(
    readonly heights: Float32Array,
    readonly rows: number,
    readonly columns: number,
    readonly place: Place,
  ) {}

  height(x: number, y: number): number {
    const { heights, rows, columns } = this;
    const { left, far, dx, dy } = this.place;
    const c = Math.min(Math.max((x - left) / dx - 0.5, 0), columns - 1);
    const r = Math.min(Math.max((far - y) / dy - 0.5, 0), rows - 1);
    const i = Math.min(Math.floor(c), Math.max(columns - 2, 0));
    const j = Math.min(Math.floor(r), Math.max(rows - 2, 0));
    const right = columns > 1 ? 1 : 0;
    const meetVertical = rows > 1 ? columns : 0;
    const [fx, fy, k] = [c - i, r - j, j * columns + i];
    const upper = heights[k] * (1 - fx) + heights[k + right] * fx;
    const lower = heights[k + meetVertical] * (1 - fx) + heights[k + meetVertical + right] * fx;
    return upper * (1 - fy) + lower * fy;
  }

  /** Build the pyramid of `meet` ahead of its use. */
  prepare(): void {
    this.tops ??= this.buildPyramid();
  }

  /** Return the cell that contains a place, or is nearest to it. */
  cell(x: number, y: number): number {
    const { left, far, dx, dy } = this.place;
    const i = Math.min(Math.max(Math.floor((x - left) / dx), 0), this.columns - 1);
    const j = Math.min(Math.max(Math.floor((far - y) / dy), 0), this.rows - 1);
    return j * this.columns + i;
  }

  /** Return whether a place lies between four centres of the grid. */
  covers(x: number, y: number): boolean {
    const { left, far, dx, dy } = this.place;
    const [u, v] = [(x - left) / dx, (far - y) / dy];
    return u >= 0.5 && v >= 0.5 && u <= this.columns - 0.5 && v <= this.rows - 0.5;
  }

  /** Return where a ray from o along d first is on the surface or below it, between t = from and to; NaN if nowhere.
   *
   * Blocks that it passes above are skipped; in every other square the bilinear surface is met exactly. */
  meet(o: Vec, d: Vec, from: number, to: number): number {
    const tops = (this.tops ??= this.buildPyramid());
    const { left, far, dx, dy } = this.place;
    const [su, sv] = [d[0] / dx, -d[1] / dy];
    const speed = Math.max(Math.abs(su), Math.abs(sv));
    if (speed * (to - from) < BEYOND) return this.below(o, d, from, to);
    const nudge = BEYOND / speed;
    const [u0, v0] = [(o[0] - left) / dx + 0.5, (far - o[1]) / dy + 0.5]; // square a lies
    let level = tops.length - 1;
    let t = from;
    while (t < to) {
      const { size, columns, top } = tops[level];
      const [u, v] = [u0 + su * (t + nudge), v0 + sv * (t + nudge)];
      const a = Math.min(Math.max(Math.floor(u / size), 0), columns - 1);
      const b = Math.min(Math.max(Math.floor(v / size), 0), top.length / columns - 1);
      const out = Math.min(exitOf(u0, su, a * size, size), exitOf(v0, sv, b * size, size), to);
      const end = Math.max(out, t + nudge);
      if (o[2] + d[2] * (d[2] < 0 ? end : t) > top[b * columns + a]) {
        t = end;
        if (level < tops.length - 1) level++;
      } else if (level > 0) level--;
      else {
        const met = this.meetSquare(a, b, u0, v0, su, sv, o[2], d[2], t, end);
        if (met === met) return met;
        t = end;
      }
    }
    return NaN;
  }

  /** Meet a vertical ray. */
  private below(o: Vec, d: Vec, from: number, to: number): number {
    const z = this.height(o[0] + from * d[0], o[1] + from * d[1]);
    if (o[2] + from * d[2] <= z) return from;
    const t = (z - o[2]) / d[2];
    return t >= from && t <= to ? t : NaN;
  }

  /** Meet a ray in one square, where height - ray is a quadratic polynomial in t. */
  private meetSquare(
    a: number, b: number, u0: number, v0: number, su: number, sv: number, oz: number, dz: number, from: number, to: number,
  ): number {
    const { heights, rows, columns } = this;
    const [i, j] = [Math.max(a - 1, 0), Math.max(b - 1, 0) * columns];
    const [right, below] = [Math.min(a, columns - 1), Math.min(b, rows - 1) * columns];
    const z = heights[j + i];
    const [zu, zv] = [heights[j + right] - z, heights[below + i] - z];
    const zuv = heights[below + right] - z - zu - zv;
    const [p, q] = [u0 + su * from - a, v0 + sv * from - b];
    const constant = oz + dz * from - (z + zu * p + zv * q + zuv * p * q);
    if (constant <= 0) return from;
    const linear = dz - (zu * su + zv * sv + zuv * (p * sv + q * su));
    const root = firstRoot(-zuv * su * sv, linear, constant);
    return root <= to - from ? from + root : NaN;
  }

  private buildPyramid(): PyramidLevel[] {
    const { heights, rows, columns } = this;
    let [n, m] = [columns + 1, rows + 1];
    let top = new Float32Array(n * m);
    for (let b = 0, k = 0; b < m; b++) {
      const [j, below] = [Math.max(b - 1, 0) * columns, Math.min(b, rows - 1) * columns];
      for (let a = 0; a < n; a++, k++) {
        const i = a > 0 ? a - 1 : 0;
        const right = a < columns ? a : columns - 1;
        let most = heights[j + i];
        if (heights[j + right] > most) most = heights[j + right];
        if (heights[below + i] > most) most = heights[below + i];
        if (heights[below + right] > most) most = heights[below + right];
        top[k] = most;
      }
    }
    const levels: PyramidLevel[] = [{ size: 1, columns: n, top }];
    for (let size = BLOCK; n > 1 || m > 1; size *= BLOCK) {
      [top, n, m] = coarsen(top, n, m);
      levels.push({ size, columns: n, top });
    }
    return levels;
  }
}

function coarsen(top: Float32Array<ArrayBuffer>, n: number, m: number): [Float32Array<ArrayBuffer>, number, number] {
  const [columns, rows] = [Math.ceil(n / BLOCK), Math.ceil(m / BLOCK)];
  const coarse = new Float32Array(columns * rows).fill(-Infinity);
  for (let b = 0, k = 0; b < m; b++)
    for (let a = 0, at = Math.floor(b / BLOCK) * columns; a < n; a++, k++) {
      const place = at + ((a / BLOCK) | 0);
      if (top[k] > coarse[place]) coarse[place] = top[k];
    }
  return [coarse, columns, rows];
}

/** Return when a coordinate leaves an interval. */
function exitOf(start: number, speed: number, low: number, size: number): number {
  return speed === 0 ? Infinity : ((speed > 0 ? low + size : low) - start) / speed;
}

/** Return the smallest t > 0 of a t^2 + b t + c = 0, where c > 0; Infinity if there is none. */
export function firstRoot(a: number, b: number, c: number): number {
  const under = b * b - 4 * a * c;
  if (under < 0) return Infinity;
  const q = -0.5 * (b + (b < 0 ? -1 : 1) * Math.sqrt(under)); // avoids cancellation
  const [one, other] = [q / a, c / q];
  const least = Math.min(one > 0 ? one : Infinity, other > 0 ? other : Infinity);
  return Number.isNaN(least) ? Infinity : least;
}
