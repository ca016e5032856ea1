/** Merging of small pieces into adjacent parts. */
import type { Labels } from "./labels";
import type { Patch } from "./patch";
import { findPieces } from "./pieces";
import { eachRun } from "./split";

/** Passes, because a small piece may be merged into a piece that is small itself. */
const PASSES = 8;

/** Merge pieces of fewer than `least` pixels into the part to their left, or above; a part's largest piece stays. */
export function mergeSmallPieces(labels: Labels, least: number, patch: Patch): void {
  for (let pass = 0; pass < PASSES && merge(labels, least, patch); pass++);
}

/** Return whether a piece was merged. */
function merge(labels: Labels, least: number, patch: Patch): boolean {
  const { data, columns } = labels;
  const found = findPieces(labels);
  const seen = new Set<number>();
  let merged = false;
  for (const { label, pixels, root } of found.pieces.sort((a, b) => b.pixels - a.pixels)) {
    const isLargest = !seen.has(label);
    seen.add(label);
    if (isLargest || pixels >= least) continue;
    const start = found.starts[root]!;
    const next = start % columns ? start - 1 : start >= columns ? start - columns : found.ends[root]!;
    const taker = data[next]!;
    eachRun(found, root, (from, to) => patch.put(data, from, to, taker));
    merged = true;
  }
  return merged;
}
