/** A part cut in two by a line: what then no longer hangs together with its largest piece becomes a part of its own. */
import { beside, type Labels, type Point } from "./labels";
import { Patch } from "./patch";
import { type Found, piecesOf } from "./pieces";

/** No part has this number. */
const CUT = 0xffff;

/** Pixels from place to place that no side of a pixel leads across, in their order. */
export function lineOf(points: readonly Point[], { columns, rows }: Labels): number[] {
  const met = new Set<number>();
  for (let i = 0; i < Math.max(1, points.length - 1); i++) {
    const a = pixel(points[i]!);
    const b = pixel(points[i + 1] ?? points[i]!);
    const steps = Math.max(Math.abs(b[0] - a[0]), Math.abs(b[1] - a[1]), 1);
    for (let step = 0; step <= steps; step++) {
      const x = Math.round(a[0] + ((b[0] - a[0]) * step) / steps);
      const y = Math.round(a[1] + ((b[1] - a[1]) * step) / steps);
      if (x >= 0 && y >= 0 && x < columns && y < rows) met.add(y * columns + x);
    }
  }
  return [...met];
}

const pixel = ([x, y]: Point): Point => [Math.floor(x), Math.floor(y)];

/**
 * Cut a part. The largest of the pieces on the line keeps the number, the others take the next ones from `next` on.
 * Null, and nothing is changed, if the line leaves it in one piece.
 */
export function split(labels: Labels, label: number, points: readonly Point[], next: number): { patch: Patch; fresh: number[] } | null {
  const { data } = labels;
  const line = lineOf(points, labels).filter((at) => data[at] === label);
  const patch = new Patch();
  for (const at of line) patch.put(data, at, at + 1, CUT);
  const found = piecesOf(labels, label);
  const cut = besideLine(found, line, labels);
  if (cut.length < 2) {
    patch.undo(data);
    return null;
  }
  const fresh = cut.slice(1).map((root, i) => {
    runs(found, root, (start, end) => patch.put(data, start, end, next + i));
    return next + i;
  });
  heal(labels, line, new Set([label, ...fresh]), label, patch);
  return { patch: patch.close(), fresh };
}

/** The pieces that touch the line, the largest first. */
function besideLine(found: Found, line: number[], labels: Labels): number[] {
  const touched = new Set<number>();
  for (const at of line)
    for (const near of beside(labels, at)) {
      const run = runAt(found, near);
      if (run >= 0) touched.add(found.roots[run]!);
    }
  return found.pieces
    .filter(({ root }) => touched.has(root))
    .sort((a, b) => b.pixels - a.pixels)
    .map(({ root }) => root);
}

function runAt({ starts, ends }: Found, at: number): number {
  let [low, high] = [0, starts.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (starts[middle]! <= at) low = middle + 1;
    else high = middle;
  }
  return low > 0 && at < ends[low - 1]! ? low - 1 : -1;
}

/** Each run of a piece. */
export function runs({ starts, ends, roots }: Found, root: number, hear: (start: number, end: number) => void): void {
  for (let i = root; i < starts.length; i++) if (roots[i] === root) hear(starts[i]!, ends[i]!);
}

/** The line's own pixels go to a part that they touch: first to a new one, so that none is left alone. */
function heal(labels: Labels, line: number[], parts: Set<number>, otherwise: number, patch: Patch): void {
  const { data } = labels;
  let left = line;
  while (left.length) {
    const healed = left.map((at) => {
      const near = beside(labels, at).map((each) => data[each]!).filter((each) => parts.has(each));
      return Math.max(-1, ...near);
    });
    const rest = left.filter((at, i) => {
      if (healed[i]! >= 0) patch.put(data, at, at + 1, healed[i]!);
      return healed[i]! < 0;
    });
    if (rest.length === left.length) {
      for (const at of rest) patch.put(data, at, at + 1, otherwise);
      return;
    }
    left = rest;
  }
}
