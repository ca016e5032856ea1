/** Triangles between the vertices of a grid with a ring around it: (rows + 2) x (columns + 2), every stride-th of them. */

/** So many triangles are drawn in every frame of a camera that moves, where all of them take too long. */
export const MOST_MOVING = 60_000;

export function triangles(rows: number, columns: number, stride: number): Uint32Array {
  const across = pickIndices(columns, stride);
  const along = pickIndices(rows, stride);
  const wide = columns + 2;
  const index = new Uint32Array((across.length - 1) * (along.length - 1) * 6);
  let at = 0;
  for (let j = 1; j < along.length; j++) {
    const [far, near] = [along[j - 1] * wide, along[j] * wide];
    for (let i = 1; i < across.length; i++) {
      const [left, right] = [across[i - 1], across[i]];
      index[at++] = far + left;
      index[at++] = near + left;
      index[at++] = far + right;
      index[at++] = far + right;
      index[at++] = near + left;
      index[at++] = near + right;
    }
  }
  return index;
}

/** The ring's two ends, the first and the last cell, and every stride-th between. */
export function pickIndices(count: number, stride: number): number[] {
  const found = [0];
  for (let k = 1; k < count; k += stride) found.push(k);
  return [...found, count, count + 1];
}

/** How coarse a grid is drawn so that it has no more than MOST_MOVING triangles. */
export function strideOf(rows: number, columns: number): number {
  return Math.max(1, Math.ceil(Math.sqrt((2 * rows * columns) / MOST_MOVING)));
}
