/** A surface: heights, labels, materials, picture; metres, x right, y away, z up. */
import { Grid } from "./grid";
import type { Material, Meta } from "../server/messages";
import type { Vec } from "../server/protocol";

export type Labels = Uint16Array | Uint32Array;

/** Heights and labels at a level of detail. */
export interface Part {
  grid: Grid;
  labels: Labels | null;
}

export class Scene {
  /** A finer part, where the camera looks. */
  detail: Part | null = null;

  constructor(
    readonly meta: Meta,
    readonly whole: Part,
    /** Index into `meta.materials` for each label. */
    readonly kinds: Uint16Array,
    readonly photo: ImageBitmap | null,
  ) {}

  /** Return the bilinear height; constant beyond the last cell centres, NaN outside. */
  height(x: number, y: number): number {
    return this.inside(x, y) ? this.finest(x, y).grid.height(x, y) : NaN;
  }

  /** Return the place on the surface over or under a point, clamped to its rim. */
  on(x: number, y: number): Vec {
    const [w, l] = this.meta.extent_m;
    const clipRay = (part: number, side: number): number => Math.max(-side / 2, Math.min(side / 2, part));
    const [u, v] = [clipRay(x, w), clipRay(y, l)];
    return [u, v, this.height(u, v)];
  }

  /** Return the outward normal, by differences over two cells of the finest level loaded. */
  normal(x: number, y: number): Vec {
    const { dx, dy } = this.finest(x, y).grid.place;
    const [left, right] = [this.on(x - dx, y), this.on(x + dx, y)];
    const [near, far] = [this.on(x, y - dy), this.on(x, y + dy)];
    const gx = (right[2] - left[2]) / (right[0] - left[0]) || 0;
    const gy = (far[2] - near[2]) / (far[1] - near[1]) || 0;
    const n = Math.hypot(gx, gy, 1);
    return [-gx / n, -gy / n, 1 / n];
  }

  /** Return the segment at a place; null outside, or without segments. */
  label(x: number, y: number): number | null {
    if (!this.inside(x, y)) return null;
    const { grid, labels } = this.finest(x, y);
    return labels ? labels[grid.cell(x, y)] : null;
  }

  /** Return the name of the part at a place; empty if it has none. */
  part(x: number, y: number): string {
    return this.meta.parts?.[this.label(x, y) ?? -1] ?? "";
  }

  material(x: number, y: number): Material | null {
    const label = this.label(x, y);
    return label === null ? null : (this.meta.materials[this.kinds[label]] ?? null);
  }

  /** Return where a ray first meets the surface, at the finest level loaded. */
  pick(o: Vec, d: Vec): Vec | null {
    const [w, l] = this.meta.extent_m;
    const [low, high] = this.meta.height_m;
    const slack = 1e-6 * (w + l);
    const [from, to] = within(o, d, [-w / 2, -l / 2, low - slack], [w / 2, l / 2, high + slack]);
    if (!(from < to)) return null;
    const t = this.meet(o, d, from, to);
    if (t !== t) return null;
    const at = this.on(o[0] + t * d[0], o[1] + t * d[1]);
    if (t > from) at[2] = o[2] + t * d[2]; // otherwise an upright side, touched at its rim
    return at;
  }

  private meet(o: Vec, d: Vec, from: number, to: number): number {
    const { whole, detail } = this;
    if (!detail) return whole.grid.meet(o, d, from, to);
    const { rows, columns, place } = detail.grid;
    const { left, far, dx, dy } = place;
    const low: Vec = [left + dx / 2, far - (rows - 0.5) * dy, -Infinity];
    const high: Vec = [left + (columns - 0.5) * dx, far - dy / 2, Infinity];
    const [enter, leave] = within(o, d, low, high);
    if (!(Math.max(enter, from) < Math.min(leave, to))) return whole.grid.meet(o, d, from, to);
    const before = enter > from ? whole.grid.meet(o, d, from, enter) : NaN;
    if (before === before) return before;
    const there = detail.grid.meet(o, d, Math.max(enter, from), Math.min(leave, to));
    return there === there || leave >= to ? there : whole.grid.meet(o, d, leave, to);
  }

  private finest(x: number, y: number): Part {
    return this.detail?.grid.covers(x, y) ? this.detail : this.whole;
  }

  private inside(x: number, y: number): boolean {
    const [w, l] = this.meta.extent_m;
    return Math.abs(x) <= w / 2 && Math.abs(y) <= l / 2;
  }
}

/** Return where a ray is within a box, from t to t; empty if the first is not smaller. */
function within(o: Vec, d: Vec, low: Vec, high: Vec): [number, number] {
  let [from, to] = [0, Infinity];
  for (let k = 0; k < 3; k++) {
    if (d[k] === 0) {
      if (o[k] < low[k] || o[k] > high[k]) return [1, 0];
      continue;
    }
    const [p, q] = [(low[k] - o[k]) / d[k], (high[k] - o[k]) / d[k]];
    from = Math.max(from, Math.min(p, q));
    to = Math.min(to, Math.max(p, q));
  }
  return [from, to];
}
