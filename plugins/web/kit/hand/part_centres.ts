/** Centres of the parts of a surface: the place of each with the greatest clearance. */

export interface Part {
  label: number;
  at: [number, number];
}

/** Places sampled along the width. */
const COLUMNS = 96;

/** Return the centres by label. label: returns the label of a place, null outside of all parts. */
export function findPartCentres(label: (x: number, y: number) => number | null, extent_m: [number, number]): Part[] {
  const [w, l] = extent_m;
  const columns = COLUMNS;
  const rows = Math.max(1, Math.round((COLUMNS * l) / w));
  const at = (i: number): [number, number] => [
    ((i % columns) + 0.5) * (w / columns) - w / 2,
    l / 2 - (Math.floor(i / columns) + 0.5) * (l / rows),
  ];
  const labels = Array.from({ length: rows * columns }, (_, i) => label(...at(i)));
  const clear = clearances(labels, rows, columns);
  const best = new Map<number, number>();
  labels.forEach((each, i) => {
    if (each !== null && clear[i]! > (clear[best.get(each) ?? -1] ?? -1)) best.set(each, i);
  });
  return [...best].sort(([a], [b]) => a - b).map(([each, i]) => ({ label: each, at: at(i) }));
}

/** Return the distance of each cell to the nearest of another label or the rim, cells, in two passes. */
function clearances(labels: (number | null)[], rows: number, columns: number): Float64Array {
  const clear = new Float64Array(labels.length);
  const near = (i: number, j: number, inside: boolean): number => (inside && labels[i] === labels[j] ? clear[j]! : 0);
  for (let i = 0; i < labels.length; i++) {
    const [row, column] = [Math.floor(i / columns), i % columns];
    clear[i] = 1 + Math.min(near(i, i - 1, column > 0), near(i, i - columns, row > 0));
  }
  for (let i = labels.length - 1; i >= 0; i--) {
    const [row, column] = [Math.floor(i / columns), i % columns];
    const back = Math.min(near(i, i + 1, column < columns - 1), near(i, i + columns, row < rows - 1));
    clear[i] = Math.min(clear[i]!, 1 + back);
  }
  return clear;
}
