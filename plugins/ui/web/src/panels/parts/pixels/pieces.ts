/** What hangs together: pixels of one part that touch along a side. */
import type { Labels, Point } from "./labels";

/** Runs of equal pixels, row by row, and of each the piece that it belongs to. */
export interface Found {
  starts: Uint32Array;
  ends: Uint32Array;
  /** Index of the run in which its piece begins. */
  roots: Uint32Array;
  pieces: Piece[];
}

export interface Piece {
  label: number;
  pixels: number;
  /** Index of its first run. */
  root: number;
}

/** Where the name of a part is written: in the longest row of it that is near its middle. */
export interface Place {
  pixels: number;
  at: Point;
}

/** The pieces of all parts, or of one; in the order of their first pixels. */
export function piecesOf({ columns, data }: Labels, only = -1): Found {
  const { starts, ends } = runsOf(data, columns, only);
  const parent = starts.map((_, i) => i);
  const root = (i: number): number => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]!]!;
    return i;
  };
  let above = 0;
  for (let i = 0; i < starts.length; i++) {
    while (ends[above]! <= starts[i]! - columns) above++;
    for (let j = above; j < i && starts[j]! < ends[i]! - columns; j++) {
      if (data[starts[j]!] !== data[starts[i]!]) continue;
      const [a, b] = [root(i), root(j)];
      parent[Math.max(a, b)] = Math.min(a, b);
    }
  }

  const pieces = new Map<number, Piece>();
  for (let i = 0; i < starts.length; i++) {
    const at = (parent[i] = root(i));
    const piece = pieces.get(at) ?? { label: data[starts[at]!]!, pixels: 0, root: at };
    piece.pixels += ends[i]! - starts[i]!;
    pieces.set(at, piece);
  }
  return { starts, ends, roots: parent, pieces: [...pieces.values()] };
}

function runsOf(data: Uint16Array, columns: number, only: number): { starts: Uint32Array; ends: Uint32Array } {
  let starts: Uint32Array = new Uint32Array(1024);
  let ends: Uint32Array = new Uint32Array(1024);
  let count = 0;
  for (let row = 0; row < data.length; row += columns) {
    for (let at = row; at < row + columns; ) {
      const label = data[at];
      let end = at + 1;
      while (end < row + columns && data[end] === label) end++;
      if (only < 0 || label === only) {
        if (count === starts.length) [starts, ends] = [grown(starts), grown(ends)];
        starts[count] = at;
        ends[count++] = end;
      }
      at = end;
    }
  }
  return { starts: starts.slice(0, count), ends: ends.slice(0, count) };
}

function grown(of: Uint32Array): Uint32Array {
  const more = new Uint32Array(2 * of.length);
  more.set(of);
  return more;
}

/** Of every part its size, and where its name is written. */
export function placesOf({ columns, data }: Labels): Map<number, Place> {
  const { starts, ends } = runsOf(data, columns, -1);
  const sums = new Map<number, { pixels: number; y: number; best: number; at: Point }>();
  const each = (act: (sum: { pixels: number; y: number; best: number; at: Point }, start: number, length: number, y: number) => void): void => {
    for (let i = 0; i < starts.length; i++) {
      const label = data[starts[i]!]!;
      let sum = sums.get(label);
      if (!sum) sums.set(label, (sum = { pixels: 0, y: 0, best: -Infinity, at: [0, 0] }));
      act(sum, starts[i]!, ends[i]! - starts[i]!, Math.floor(starts[i]! / columns));
    }
  };
  each((sum, _, length, y) => {
    sum.pixels += length;
    sum.y += length * y;
  });
  each((sum, start, length, y) => {
    const good = length - 2 * Math.abs(y - sum.y / sum.pixels);
    if (good <= sum.best) return;
    sum.best = good;
    sum.at = [(start % columns) + length / 2, y + 0.5];
  });
  return new Map([...sums].map(([label, { pixels, at }]) => [label, { pixels, at }]));
}

/** Which parts touch a part along a side. */
export function neighboursOf({ columns, data }: Labels, label: number): Set<number> {
  const { starts, ends } = runsOf(data, columns, label);
  const met = new Set<number>([label]);
  const look = (from: number, to: number): void => {
    let last = label;
    for (let at = Math.max(0, from); at < Math.min(to, data.length); at++) if (data[at] !== last) met.add((last = data[at]!));
  };
  starts.forEach((start, i) => {
    const end = ends[i]!;
    if (start % columns) look(start - 1, start);
    if (end % columns) look(end, end + 1);
    look(start - columns, end - columns);
    look(start + columns, end + columns);
  });
  met.delete(label);
  return met;
}
