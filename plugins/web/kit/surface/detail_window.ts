/** The window of a large surface that is drawn finer: the visible part, in cells not finer than visible. */
import type { Meta } from "../server/messages";
import type { Window } from "./loading";

/** Greatest number of cells, drawn in a fraction of a second; 300 000 cells are 600 000 triangles. */
export const MAX_CELLS = 300_000;
const MAX_SIDE = 4000;
const MARGIN = 0.08;
/** Least width of a cell in pixels. */
const FINEST_PIXEL = 0.5;

/** A box of the workspace, metres. */
export interface Box {
  left: number;
  near: number;
  right: number;
  far: number;
}

/** Return the finest window that can be drawn; null if the whole is as fine. */
export function windowOf(meta: Meta, seen: Box, pixel_m: number): Window | null {
  const [w, l] = meta.extent_m;
  const [mx, my] = [MARGIN * (seen.right - seen.left), MARGIN * (seen.far - seen.near)];
  for (let level = 0; level < meta.levels.length - 1; level++) {
    const { step, rows, columns } = meta.levels[level];
    const [dx, dy] = [(step * w) / meta.columns, (step * l) / meta.rows];
    if (dx < FINEST_PIXEL * pixel_m && level < meta.levels.length - 2) continue;
    const [column, right] = span((seen.left - mx + w / 2) / dx, (seen.right + mx + w / 2) / dx, columns);
    const [row, near] = span((l / 2 - seen.far - my) / dy, (l / 2 - seen.near + my) / dy, rows);
    const found = { level, row, rows: near - row, column, columns: right - column };
    if (found.rows < 1 || found.columns < 1) return null;
    if (found.rows * found.columns <= MAX_CELLS && Math.max(found.rows, found.columns) <= MAX_SIDE) return found;
  }
  return null;
}

/** Return whether a window includes another one. */
export function includes(one: Window, other: Window): boolean {
  const along = one.row <= other.row && one.row + one.rows >= other.row + other.rows;
  return one.level === other.level && along && one.column <= other.column && one.column + one.columns >= other.column + other.columns;
}

function span(from: number, to: number, count: number): [number, number] {
  const within = (value: number): number => Math.min(Math.max(value, 0), count);
  return [within(Math.floor(from)), within(Math.ceil(to))];
}
