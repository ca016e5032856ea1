/** Labels: a part's number for each pixel, row by row. */

/** A box: first row and column, and the ones after the last. */
export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** Pixels of a row: first, and the one after the last. */
export type Span = readonly [row: number, from: number, to: number];
export type Point = readonly [x: number, y: number];

export interface Labels {
  readonly columns: number;
  readonly rows: number;
  readonly data: Uint16Array;
}

export const EMPTY: Box = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity };

export const isEmpty = ({ left, right, top, bottom }: Box): boolean => !(left < right && top < bottom);

export const union = (a: Box, b: Box): Box => ({
  left: Math.min(a.left, b.left),
  top: Math.min(a.top, b.top),
  right: Math.max(a.right, b.right),
  bottom: Math.max(a.bottom, b.bottom),
});

/** Return the bounding box of spans. */
export function boundingBox(spans: readonly Span[]): Box {
  let { left, top, right, bottom } = EMPTY;
  for (const [row, from, to] of spans) {
    left = Math.min(left, from);
    right = Math.max(right, to);
    top = Math.min(top, row);
    bottom = Math.max(bottom, row + 1);
  }
  return { left, top, right, bottom };
}

/** Return the part at a pixel; -1 outside of the picture. */
export function labelAt({ columns, rows, data }: Labels, x: number, y: number): number {
  const [column, row] = [Math.floor(x), Math.floor(y)];
  return column >= 0 && row >= 0 && column < columns && row < rows ? data[row * columns + column]! : -1;
}

/** Return the pixels that share a side with one. */
export function adjacentPixels({ columns, data }: Labels, at: number): number[] {
  const column = at % columns;
  const all = [at - columns, at + columns, column ? at - 1 : -1, column < columns - 1 ? at + 1 : -1];
  return all.filter((each) => each >= 0 && each < data.length);
}

/** Return the number of pixels of each part. */
export function countPixels({ data }: Labels): Uint32Array {
  const counts = new Uint32Array(0x10000);
  for (let i = 0; i < data.length; i++) counts[data[i]!]!++;
  return counts;
}
