/** The resting point of the proxy: the nearest point of the surface, or where friction holds it.
 *
 * The counterpart of tangible_render/contact/closest.py, with its guards of Newton's method, but for its last step, where
 * a Taylor series saves time that a page has. */
import type { Expansion, Spline } from "./spline";

const STEPS = 8;
const STEP_M = 2.5e-4;
const BACK_OFFS = 3;
const BACK_OFF = 0.35;
/** Length of a step after which the proxy counts as arrived, metres. */
const NEAR_M = 1e-8;
const STEEP = 0.1;

export interface Proxy {
  x: number;
  y: number;
  at: Expansion;
  slides: boolean;
}

/** Return the proxy of a hand at (x, y, z), from the last one. */
export function settle(
  spline: Spline, from: Omit<Proxy, "at">, [x, y, z]: readonly number[], staticFriction: number, dynamicFriction: number,
): Proxy {
  let { x: px, y: py, slides } = from;
  let at = spline.bend(px, py);
  if (staticFriction > 0) {
    const [along, normal] = parts(at, x! - px, y! - py, z! - at[0]);
    if (along <= (slides ? dynamicFriction : staticFriction) * normal) return { x: px, y: py, at, slides: false };
    slides = true;
  }
  for (let step = 0; step < STEPS; step++) {
    const away = [x! - px, y! - py, z! - at[0]] as const;
    let share = 1;
    if (staticFriction > 0) {
      const [along, normal] = parts(at, ...away);
      share = 1 - (dynamicFriction * normal) / along;
      if (!(share > 0)) break;
    }
    let [sx, sy] = newton(spline, px, py, away, at, share);
    const before = square(...away);
    let there = spline.bend(px + sx, py + sy);
    const nearer = (): boolean => square(x! - px - sx, y! - py - sy, z! - there[0]) < before;
    for (let back = 0; back < BACK_OFFS && !nearer(); back++) {
      [sx, sy] = [BACK_OFF * sx, BACK_OFF * sy];
      there = spline.bend(px + sx, py + sy);
    }
    if (!nearer()) break;
    [px, py, at] = [px + sx, py + sy, there];
    if (sx * sx + sy * sy <= NEAR_M * NEAR_M) break;
  }
  return { x: px, y: py, at, slides };
}

/** Return the lengths of the way from proxy to hand along the surface and along its normal. */
function parts([, hx, hy]: Expansion, dx: number, dy: number, dz: number): [number, number] {
  const inward = hx * dx + hy * dy - dz;
  const normal2 = (inward * inward) / (1 + hx * hx + hy * hy);
  return [Math.sqrt(Math.max(square(dx, dy, dz) - normal2, 0)), Math.sqrt(normal2)];
}

/** Return this share of Newton's step, or of the Gauss-Newton step, within the borders. */
function newton(
  { widthM, lengthM }: Spline, px: number, py: number, [dx, dy, dz]: readonly [number, number, number],
  [, hx, hy, hxx, hxy, hyy]: Expansion, share: number,
): [number, number] {
  const [halfX, halfY] = [0.5 * widthM, 0.5 * lengthM];
  const [gx, gy] = [share * (dx + hx * dz), share * (dy + hy * dz)];
  let [xx, xy, yy] = [1 + hx * hx, hx * hy, 1 + hy * hy];
  const plain = xx + hy * hy;
  const [nxx, nxy, nyy] = [xx - hxx * dz, xy - hxy * dz, yy - hyy * dz];
  let determinant = nxx * nyy - nxy * nxy;
  if (nxx > 0 && determinant > STEEP * plain) [xx, xy, yy] = [nxx, nxy, nyy];
  else determinant = plain;
  let [sx, sy] = [(yy * gx - xy * gy) / determinant, (xx * gy - xy * gx) / determinant];
  if (Math.abs(px + sx) > halfX) {
    sx = Math.sign(px + sx) * halfX - px;
    sy = (gy - xy * sx) / yy;
  }
  if (Math.abs(py + sy) > halfY) {
    sy = Math.sign(py + sy) * halfY - py;
    sx = Math.min(Math.max((gx - xy * sy) / xx, -halfX - px), halfX - px);
  }
  const shorter = Math.min(1, STEP_M / Math.hypot(sx, sy) || 1);
  return [shorter * sx, shorter * sy];
}

const square = (dx: number, dy: number, dz: number): number => dx * dx + dy * dy + dz * dz;
