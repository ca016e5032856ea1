/** The pixels within an outline that a hand drew: what it goes around once or more, also where it crosses itself. */
import type { Point, Span } from "./labels";

interface Edge {
  top: number;
  bottom: number;
  /** Where it is at y = 0, and how far it goes for each row. */
  x: number;
  slope: number;
  way: 1 | -1;
}

export function filled(outline: readonly Point[], columns: number, rows: number): Span[] {
  const edges = edgesOf(outline);
  const top = Math.max(0, Math.floor(Math.min(...edges.map((each) => each.top))));
  const bottom = Math.min(rows, Math.ceil(Math.max(...edges.map((each) => each.bottom))));
  const spans: Span[] = [];
  for (let row = top; row < bottom; row++) fillRow(row, edges, columns, spans);
  return spans;
}

function edgesOf(outline: readonly Point[]): Edge[] {
  return outline.flatMap(([x0, y0], i) => {
    const [x1, y1] = outline[(i + 1) % outline.length]!;
    if (y0 === y1) return [];
    const slope = (x1 - x0) / (y1 - y0);
    return [{ top: Math.min(y0, y1), bottom: Math.max(y0, y1), x: x0 - y0 * slope, slope, way: y1 > y0 ? 1 : -1 } as Edge];
  });
}

function fillRow(row: number, edges: Edge[], columns: number, spans: Span[]): void {
  const y = row + 0.5;
  const met = edges
    .filter(({ top, bottom }) => y >= top && y < bottom)
    .map(({ x, slope, way }) => ({ x: x + y * slope, way }))
    .sort((a, b) => a.x - b.x);
  let around = 0;
  for (const [i, { x, way }] of met.entries()) {
    around += way;
    if (!around) continue;
    const from = Math.max(0, Math.ceil(x - 0.5));
    const to = Math.min(columns, Math.ceil(met[i + 1]!.x - 0.5));
    if (from < to) spans.push([row, from, to]);
  }
}
