/** What is felt, as the page has it: heights, labels, the photo; metres, x right, y away, z up. */
import { bulk } from "./net";
import type { Material, Meta } from "./messages";
import type { Vec } from "./protocol";

export class Scene {
  constructor(
    readonly meta: Meta,
    readonly heights: Float32Array,
    readonly labels: Uint16Array,
    readonly photo: ImageBitmap | null,
  ) {}

  static async load(meta: Meta): Promise<Scene> {
    const at = `/scene/${meta.digest}`;
    const [heights, labels, photo] = await Promise.all([
      bulk(`${at}/height.f32`).then((r) => r.arrayBuffer()),
      bulk(`${at}/labels.u16`).then((r) => r.arrayBuffer()),
      meta.photo ? bulk(`${at}/photo.jpg`).then((r) => r.blob()).then((b) => createImageBitmap(b)) : null,
    ]);
    return new Scene(meta, new Float32Array(heights), new Uint16Array(labels), photo);
  }

  private cell(x: number, y: number): [number, number] {
    const {
      rows,
      columns,
      extent_m: [w, l],
    } = this.meta;
    return [(x / w + 0.5) * columns - 0.5, (0.5 - y / l) * rows - 0.5];
  }

  /** Bilinear height; the rim's beyond the last cell centres, NaN outside. */
  height(x: number, y: number): number {
    const {
      rows,
      columns,
      extent_m: [w, l],
    } = this.meta;
    if (Math.abs(x) > w / 2 || Math.abs(y) > l / 2) return NaN;
    const [u, v] = this.cell(x, y),
      c = Math.min(Math.max(u, 0), columns - 1.001),
      r = Math.min(Math.max(v, 0), rows - 1.001);
    const i = c | 0,
      j = r | 0,
      fx = c - i,
      fy = r - j,
      k = j * columns + i,
      z = this.heights;
    return (z[k] * (1 - fx) + z[k + 1] * fx) * (1 - fy) + (z[k + columns] * (1 - fx) + z[k + columns + 1] * fx) * fy;
  }

  /** The place on the surface over or under a point, within its rim. */
  on(x: number, y: number): Vec {
    const [w, l] = this.meta.extent_m;
    const inside = (part: number, side: number): number => Math.max(-side / 2, Math.min(side / 2, part));
    const [u, v] = [inside(x, w), inside(y, l)];
    return [u, v, this.height(u, v)];
  }

  normal(x: number, y: number): Vec {
    const d = this.meta.extent_m[0] / this.meta.columns;
    const gx = (this.height(x + d, y) - this.height(x - d, y)) / (2 * d) || 0,
      gy = (this.height(x, y + d) - this.height(x, y - d)) / (2 * d) || 0;
    const n = Math.hypot(gx, gy, 1);
    return [-gx / n, -gy / n, 1 / n];
  }

  /** The segment there; null outside. */
  label(x: number, y: number): number | null {
    const { rows, columns } = this.meta;
    const [i, j] = this.cell(x, y).map(Math.round);
    return i < 0 || j < 0 || i >= columns || j >= rows ? null : this.labels[j * columns + i];
  }

  material(x: number, y: number): Material | null {
    const { rows, columns, materials } = this.meta,
      [u, v] = this.cell(x, y),
      i = Math.round(u),
      j = Math.round(v);
    return i < 0 || j < 0 || i >= columns || j >= rows ? null : (materials[this.labels[j * columns + i]] ?? null);
  }

  /** Where a ray meets the surface first: every cell on its way is looked at, so that no spike is leapt over. */
  pick(o: Vec, d: Vec): Vec | null {
    const {
      rows,
      columns,
      extent_m: [w, l],
      height_m: [low, high],
    } = this.meta;
    let t0 = 0,
      t1 = Infinity;
    for (const [from, by, a, b] of [
      [o[0], d[0], -w / 2, w / 2],
      [o[1], d[1], -l / 2, l / 2],
      [o[2], d[2], low - 1e-6, high + 1e-6],
    ]) {
      if (by === 0) {
        if (from < a || from > b) return null;
        continue;
      }
      const p = (a - from) / by,
        q = (b - from) / by;
      t0 = Math.max(t0, Math.min(p, q));
      t1 = Math.min(t1, Math.max(p, q));
    }
    if (t0 >= t1) return null;
    const above = (t: number) => o[2] + t * d[2] - (this.height(o[0] + t * d[0], o[1] + t * d[1]) || 0);
    const [ex, ey] = [o[0] + t0 * d[0], o[1] + t0 * d[1]];
    if (above(t0 + 1e-9) < -1e-9) return [ex, ey, this.height(ex * 0.9999, ey * 0.9999)]; // an upright side: its rim
    const su = (d[0] / w) * columns,
      sv = (-d[1] / l) * rows; // cells per unit of t
    let t = t0 + 1e-9,
      before = t0,
      [u, v] = this.cell(o[0] + t * d[0], o[1] + t * d[1]);
    for (let n = 0; n < rows + columns + 2; n++) {
      const nu = su > 0 ? Math.floor(u) + 1 : Math.ceil(u) - 1,
        nv = sv > 0 ? Math.floor(v) + 1 : Math.ceil(v) - 1;
      const step = Math.min(su ? (nu - u) / su : Infinity, sv ? (nv - v) / sv : Infinity, t1 - t);
      t += Math.max(step, 1e-12);
      u += step * su;
      v += step * sv;
      if (above(t) <= 0 || t >= t1 - 1e-12) {
        for (let k = 0, a = before, b = t; k < 24; k++) {
          const m = (a + b) / 2;
          if (above(m) <= 0) b = m;
          else a = m;
          t = b;
        }
        return [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
      }
      before = t;
    }
    return null;
  }
}
