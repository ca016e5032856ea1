/** Triangles of a grid with a ring around it: (rows + 2) x (columns + 2) vertices, every stride-th of them. */

/** Greatest number of triangles per frame while the camera moves, on slow graphics. */
export const MAX_MOVING = 60_000;

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

/** Return the indices of the ring, the first and the last cell, and every stride-th between. */
export function pickIndices(count: number, stride: number): number[] {
  const indices = [0];
  for (let k = 1; k < count; k += stride) indices.push(k);
  return [...indices, count, count + 1];
}

/** Return the stride for at most MAX_MOVING triangles. */
export function strideOf(rows: number, columns: number): number {
  return Math.max(1, Math.ceil(Math.sqrt((2 * rows * columns) / MAX_MOVING)));
}
