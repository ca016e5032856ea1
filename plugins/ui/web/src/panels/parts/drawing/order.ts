/** Order from front to back: higher parts are in front. */

export interface Standing {
  label: number;
  height_m: number;
}

/** Height difference that a finger notices, metres. */
const STEP_M = 0.0005;

/** Return parts from front to back; of equal heights, the lower number first. */
export function frontToBack<T extends Standing>(parts: readonly T[]): T[] {
  return [...parts].sort((a, b) => b.height_m - a.height_m || a.label - b.label);
}

/** Return parts with the heights after one moved some places to the front (or back, if negative), from the front.
 *
 * Present heights stay if possible; equal ones are spread so that neighbours differ noticeably. */
export function reorder<T extends Standing>(parts: readonly T[], label: number, by: number, top_m: number): T[] {
  const before = frontToBack(parts);
  const from = before.findIndex((each) => each.label === label);
  const to = Math.max(0, Math.min(before.length - 1, from - by));
  const after = before.filter((each) => each.label !== label);
  after.splice(to, 0, before[from]!);
  if (to === from) return before;
  const heights = spread(before.map((each) => each.height_m).reverse(), top_m).reverse();
  return after.map((each, i) => ({ ...each, height_m: heights[i]! }));
}

/** Return heights, from low to high, spread by a noticeable step and not above the top. */
export function spread(heights_m: readonly number[], top_m: number): number[] {
  const step = Math.min(STEP_M, top_m / Math.max(1, heights_m.length - 1));
  const indices = [...heights_m];
  for (let i = 1; i < indices.length; i++) indices[i] = Math.max(indices[i]!, indices[i - 1]! + step);
  let most = top_m;
  for (let i = indices.length - 1; i >= 0; i--) {
    indices[i] = Math.max(0, Math.min(indices[i]!, most));
    most = indices[i]! - step;
  }
  return indices;
}
