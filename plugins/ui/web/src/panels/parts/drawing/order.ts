/** Front to back: what is higher stands in front of what is lower. */

export interface Standing {
  label: number;
  height_m: number;
}

/** A difference that a finger finds. */
const STEP_M = 0.0005;

/** The foremost first; of equal heights, the one with the lower number. */
export function fromFront<T extends Standing>(parts: readonly T[]): T[] {
  return [...parts].sort((a, b) => b.height_m - a.height_m || a.label - b.label);
}

/**
 * The heights after a part went by so many places to the front (or to the back, below 0), in the order from the front.
 * The heights that were there stay where they can; equal ones are spread, so that each part is felt before the next.
 */
export function moved<T extends Standing>(parts: readonly T[], label: number, by: number, top_m: number): T[] {
  const before = fromFront(parts);
  const from = before.findIndex((each) => each.label === label);
  const to = Math.max(0, Math.min(before.length - 1, from - by));
  const after = before.filter((each) => each.label !== label);
  after.splice(to, 0, before[from]!);
  if (to === from) return before;
  const heights = spread(before.map((each) => each.height_m).reverse(), top_m).reverse();
  return after.map((each, i) => ({ ...each, height_m: heights[i]! }));
}

/** Heights from low to high: none nearer to the next than a step that is felt, and none above the top. */
export function spread(heights_m: readonly number[], top_m: number): number[] {
  const step = Math.min(STEP_M, top_m / Math.max(1, heights_m.length - 1));
  const made = [...heights_m];
  for (let i = 1; i < made.length; i++) made[i] = Math.max(made[i]!, made[i - 1]! + step);
  let most = top_m;
  for (let i = made.length - 1; i >= 0; i--) {
    made[i] = Math.max(0, Math.min(made[i]!, most));
    most = made[i]! - step;
  }
  return made;
}
