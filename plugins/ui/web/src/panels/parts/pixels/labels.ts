/** A number for each pixel, row by row: which part it belongs to. */

/** Rows and columns from the first on to before the last. */
export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** Pixels of a row, from one on to before another. */
export type Span = readonly [row: number, from: number, to: number];
export type Point = readonly [x: number, y: number];

export interface Labels {
  readonly columns: number;
  readonly rows: number;
  readonly data: Uint16Array;
}

export const EMPTY: Box = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity };

export const isEmpty = ({ left, right, top, bottom }: Box): boolean => !(left < right && top < bottom);

export const around = (a: Box, b: Box): Box => ({
  left: Math.min(a.left, b.left),
  top: Math.min(a.top, b.top),
  right: Math.max(a.right, b.right),
  bottom: Math.max(a.bottom, b.bottom),
});

/** The box of spans that are within the picture. */
export function boxOf(spans: readonly Span[]): Box {
  let { left, top, right, bottom } = EMPTY;
  for (const [row, from, to] of spans) {
    left = Math.min(left, from);
    right = Math.max(right, to);
    top = Math.min(top, row);
    bottom = Math.max(bottom, row + 1);
  }
  return { left, top, right, bottom };
}

/** The part at a pixel; -1 beside the picture. */
export function labelAt({ columns, rows, data }: Labels, x: number, y: number): number {
  const [column, row] = [Math.floor(x), Math.floor(y)];
  return column >= 0 && row >= 0 && column < columns && row < rows ? data[row * columns + column]! : -1;
}

/** The pixels that share a side with one. */
export function beside({ columns, data }: Labels, at: number): number[] {
  const column = at % columns;
  const all = [at - columns, at + columns, column ? at - 1 : -1, column < columns - 1 ? at + 1 : -1];
  return all.filter((each) => each >= 0 && each < data.length);
}

/** How many pixels each part has, by its number. */
export function counted({ data }: Labels): Uint32Array {
  const counts = new Uint32Array(0x10000);
  for (let i = 0; i < data.length; i++) counts[data[i]!]!++;
  return counts;
}
