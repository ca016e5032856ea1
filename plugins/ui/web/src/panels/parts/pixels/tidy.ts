/** Slivers: pieces too small or too thin to be felt, which their surroundings take. */
import type { Labels } from "./labels";
import type { Patch } from "./patch";
import { findPieces, type Pieces } from "./pieces";

/** Passes, because a sliver may go to a piece that is a sliver itself. */
const PASSES = 16;
/** A sliver's pixels, as a share of the picture's. */
const MIN_SHARE = 0.0005;
/** A sliver's width, as a share of the picture's longer side: half a millimetre of 80. */
const MIN_WIDTH = 0.006;

/** Pieces below either of these are slivers; in pixels. */
export interface Limits {
  pixels: number;
  width: number;
}

/** A piece with the sides that it shares with others: their labels, and the count of each. */
interface Measured {
  label: number;
  pixels: number;
  sides: number;
  around: Map<number, number>;
  runs: [start: number, end: number][];
}

export function sliversOf({ columns, rows }: Labels): Limits {
  return { pixels: MIN_SHARE * columns * rows, width: MIN_WIDTH * Math.max(columns, rows) };
}

/** Give slivers to the part with which they share most of their border; return how many went.
 *
 * keeps: whether a part's largest piece stays, however small it is. to: a part that takes none if another can. */
export function giveAway(labels: Labels, limits: Limits, patch: Patch, keeps: (label: number) => boolean, to = -1): number {
  let gone = 0;
  for (let pass = 0; pass < PASSES; pass++) {
    const now = onePass(labels, limits, patch, keeps, to);
    if (!now) break;
    gone += now;
  }
  return gone;
}

function onePass(labels: Labels, limits: Limits, patch: Patch, keeps: (label: number) => boolean, to: number): number {
  const seen = new Set<number>();
  const changed = new Set<number>();
  let gone = 0;
  for (const piece of measure(labels, findPieces(labels)).sort((a, b) => b.pixels - a.pixels)) {
    const stays = !seen.has(piece.label) && keeps(piece.label);
    seen.add(piece.label);
    if (stays || (piece.pixels >= limits.pixels && (2 * piece.pixels) / piece.sides >= limits.width)) continue;
    const others = [...piece.around].filter(([label]) => label !== piece.label).sort((a, b) => b[1] - a[1]);
    const taker = (others.find(([label]) => label !== to) ?? others[0])?.[0];
    if (taker === undefined || [...piece.around.keys()].some((each) => changed.has(each))) continue; // else two slivers change places
    changed.add(piece.label);
    for (const [start, end] of piece.runs) patch.put(labels.data, start, end, taker);
    gone++;
  }
  return gone;
}

function measure({ columns, data }: Labels, { starts, ends, roots, pieces }: Pieces): Measured[] {
  const found = new Map<number, Measured>();
  for (const { label, pixels, root } of pieces) found.set(root, { label, pixels, sides: 0, around: new Map(), runs: [] });
  for (let i = 0; i < starts.length; i++) {
    const piece = found.get(roots[i]!)!;
    const [start, end] = [starts[i]!, ends[i]!];
    const meet = (other: number | undefined): void => {
      if (other === piece.label) return;
      piece.sides++;
      if (other !== undefined) piece.around.set(other, (piece.around.get(other) ?? 0) + 1);
    };
    piece.runs.push([start, end]);
    meet(start % columns ? data[start - 1] : undefined);
    meet(end % columns ? data[end] : undefined);
    for (let at = start; at < end; at++) {
      meet(data[at - columns]);
      meet(data[at + columns]);
    }
  }
  return [...found.values()];
}
