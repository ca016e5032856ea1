/** Small pictures of parts, drawn in letters. */
import { Drawing, type Part } from "../../src/panels/parts/drawing/drawing";
import type { Limits } from "../../src/panels/parts/pixels/tidy";
import type { Labels, Span } from "../../src/panels/parts/pixels/labels";

export const part = (label: number, more: Partial<Part> = {}): Part => ({ label, name: "", height_m: 0, material: null, automatic: false, ...more });

/** A picture drawn in letters: each is a part. */
export function picture(...lines: string[]): Labels {
  const [columns, rows] = [lines[0]!.length, lines.length];
  return { columns, rows, data: Uint16Array.from(lines.join(""), (each) => each.charCodeAt(0) - 97) };
}

export const drawn = ({ columns, data }: Labels): string[] =>
  Array.from({ length: data.length / columns }, (_, row) =>
    String.fromCharCode(...data.subarray(row * columns, (row + 1) * columns).map((each) => each + 97)),
  );

/** slivers: limits in pixels; without them none is small enough. */
export function drawing(lines: string[], slivers: Limits = { pixels: 0, width: 0 }): Drawing {
  const labels = picture(...lines);
  return new Drawing(labels, [...new Set(labels.data)].sort().map((label) => part(label, { name: `part ${label}` })), 0.004, slivers);
}

export const pixels = (spans: Iterable<Span>): Set<string> =>
  new Set([...spans].flatMap(([row, from, to]) => Array.from({ length: to - from }, (_, i) => `${from + i} ${row}`)));

/** Numbers from 0 to 1, the same each time. */
export function chance(seed: number): () => number {
  return () => {
    seed = (seed * 1664525 + 1013904223) >>> 0;
    return seed / 2 ** 32;
  };
}
