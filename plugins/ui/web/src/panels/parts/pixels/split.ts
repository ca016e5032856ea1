/** Splitting of a part by a line: pieces cut off from its largest become parts. */
import { adjacentPixels, type Labels, type Point } from "./labels";
import { Patch } from "./patch";
import { type Pieces, findPieces } from "./pieces";

/** Label of pixels on the line, used by no part. */
const CUT = 0xffff;

/** Return the pixels of a polyline, 8-connected, in order. */
export function linePixels(points: readonly Point[], { columns, rows }: Labels): number[] {
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

/** Split a part. The largest piece at the line keeps the label, the others take labels from `next` on. Returns null, and
 * changes nothing, if the line leaves it in one piece. */
export function split(labels: Labels, label: number, points: readonly Point[], next: number): { patch: Patch; fresh: number[] } | null {
  const { data } = labels;
  const line = linePixels(points, labels).filter((at) => data[at] === label);
  const patch = new Patch();
  for (const at of line) patch.put(data, at, at + 1, CUT);
  const found = findPieces(labels, label);
  const cut = piecesAtLine(found, line, labels);
  if (cut.length < 2) {
    patch.undo(data);
    return null;
  }
  const fresh = cut.slice(1).map((root, i) => {
    eachRun(found, root, (start, end) => patch.put(data, start, end, next + i));
    return next + i;
  });
  heal(labels, line, new Set([label, ...fresh]), label, patch);
  return { patch: patch.close(), fresh };
}

/** Return the pieces that touch the line, the largest first. */
function piecesAtLine(found: Pieces, line: number[], labels: Labels): number[] {
  const touched = new Set<number>();
  for (const at of line)
    for (const near of adjacentPixels(labels, at)) {
      const run = runAt(found, near);
      if (run >= 0) touched.add(found.roots[run]!);
    }
  return found.pieces
    .filter(({ root }) => touched.has(root))
    .sort((a, b) => b.pixels - a.pixels)
    .map(({ root }) => root);
}

function runAt({ starts, ends }: Pieces, at: number): number {
  let [low, high] = [0, starts.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (starts[middle]! <= at) low = middle + 1;
    else high = middle;
  }
  return low > 0 && at < ends[low - 1]! ? low - 1 : -1;
}

/** Call a function with each run of a piece. */
export function eachRun({ starts, ends, roots }: Pieces, root: number, hear: (start: number, end: number) => void): void {
  for (let i = root; i < starts.length; i++) if (roots[i] === root) hear(starts[i]!, ends[i]!);
}

/** Give the line's pixels to adjacent parts, new ones first. */
function heal(labels: Labels, line: number[], parts: Set<number>, otherwise: number, patch: Patch): void {
  const { data } = labels;
  let left = line;
  while (left.length) {
    const healed = left.map((at) => {
      const near = adjacentPixels(labels, at).map((each) => data[each]!).filter((each) => parts.has(each));
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
