/** Pixels under a round brush that moves from one place to another. */
import type { Point, Span } from "./labels";

/** Least radius that leaves no hole between pixels. */
const MIN_RADIUS = 0.75;

/** Return the pixels whose centres are under it, within the picture. */
export function stroke(a: Point, b: Point, width: number, columns: number, rows: number): Span[] {
  const thin = width < 3;
  const [from, to] = thin ? [centre(a), centre(b)] : [a, b];
  const radius = Math.max(width / 2, MIN_RADIUS);
  const top = Math.max(0, Math.ceil(Math.min(from[1], to[1]) - radius - 0.5));
  const bottom = Math.min(rows, Math.floor(Math.max(from[1], to[1]) + radius - 0.5) + 1);
  const sides = edges(from, to, radius);
  const spans: Span[] = [];
  for (let row = top; row < bottom; row++) {
    const [left, right] = across(row + 0.5, from, to, radius, sides);
    const start = Math.max(0, Math.ceil(left - 0.5));
    const end = Math.min(columns, Math.floor(right - 0.5) + 1);
    if (start < end) spans.push([row, start, end]);
  }
  return spans;
}

const centre = ([x, y]: Point): Point => [Math.floor(x) + 0.5, Math.floor(y) + 0.5];

/** Return the two straight sides of the stroke. */
function edges(a: Point, b: Point, radius: number): [Point, Point][] {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  if (!length) return [];
  const [nx, ny] = [(-radius * (b[1] - a[1])) / length, (radius * (b[0] - a[0])) / length];
  return [1, -1].map((side) => [
    [a[0] + side * nx, a[1] + side * ny],
    [b[0] + side * nx, b[1] + side * ny],
  ]);
}

/** Return the interval of a row within the convex stroke. */
function across(y: number, a: Point, b: Point, radius: number, sides: [Point, Point][]): [number, number] {
  let [left, right] = [Infinity, -Infinity];
  const meet = (x: number): void => {
    left = Math.min(left, x);
    right = Math.max(right, x);
  };
  for (const [cx, cy] of [a, b]) {
    const half = radius * radius - (y - cy) ** 2;
    if (half < 0) continue;
    meet(cx - Math.sqrt(half));
    meet(cx + Math.sqrt(half));
  }
  for (const [[x0, y0], [x1, y1]] of sides) {
    const share = (y - y0) / (y1 - y0);
    if (share >= 0 && share <= 1) meet(x0 + share * (x1 - x0));
  }
  return [left, right];
}
