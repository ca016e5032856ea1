import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { stroke } from "../../src/panels/parts/pixels/brush";
import { type Labels, labelAt, type Point } from "../../src/panels/parts/pixels/labels";
import { Mask, toSpans } from "../../src/panels/parts/pixels/mask";
import { findNeighbours, findPieces, findPlaces } from "../../src/panels/parts/pixels/pieces";
import { fillOutline } from "../../src/panels/parts/pixels/polygon";
import { chance, picture, pixels } from "./pictures";

describe("brush", () => {
  test("it covers the pixels whose centres are within its width of the line, and no other", () => {
    const random = chance(1);
    for (let n = 0; n < 60; n++) {
      const [a, b] = [[40 * random() - 5, 30 * random() - 5], [40 * random() - 5, 30 * random() - 5]] as [Point, Point];
      const width = 3 + 12 * random();
      const wanted = new Set<string>();
      for (let y = 0; y < 20; y++) for (let x = 0; x < 30; x++) if (away([x + 0.5, y + 0.5], a, b) <= width / 2) wanted.add(`${x} ${y}`);
      assert.deepEqual(pixels(stroke(a, b, width, 30, 20)), wanted);
    }
  });

  test("the thinnest leaves no hole, and a dab at least a pixel", () => {
    assert.deepEqual(pixels(stroke([3.9, 2.1], [3.9, 2.1], 1, 9, 9)), new Set(["3 2"]));
    const labels = picture(...Array<string>(9).fill("aaaaaaaaa"));
    for (const [row, from, to] of stroke([0, 0], [8.9, 5.2], 1, 9, 9)) labels.data.fill(1, row * 9 + from, row * 9 + to);
    assert.equal(findPieces(labels, 1).pieces.length, 1);
  });

  test("beside the picture it covers nothing", () => assert.deepEqual(stroke([-50, -50], [-40, -60], 8, 9, 9), []));
});

function away([x, y]: Point, [ax, ay]: Point, [bx, by]: Point): number {
  const [dx, dy] = [bx - ax, by - ay];
  const share = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)));
  return Math.hypot(x - ax - share * dx, y - ay - share * dy);
}

describe("outline", () => {
  test("it covers the centres that it goes around, also where it crosses itself", () => {
    const star: Point[] = [[10, 0.2], [15, 19], [0.3, 7], [19.6, 7], [5, 19]];
    const found = pixels(fillOutline(star, 20, 20));
    for (let y = 0; y < 20; y++)
      for (let x = 0; x < 20; x++) assert.equal(found.has(`${x} ${y}`), winds([x + 0.5, y + 0.5], star), `${x} ${y}`);
    assert.ok(found.has("10 9"), "its middle, which it goes around twice");
  });

  test("two outlines that share an edge share no pixel and leave none", () => {
    const left = pixels(fillOutline([[0, 0], [3.3, 0], [6.1, 10], [0, 10]], 10, 10));
    const right = pixels(fillOutline([[3.3, 0], [10, 0], [10, 10], [6.1, 10]], 10, 10));
    assert.equal(left.size + right.size, 100);
    assert.equal([...left].filter((each) => right.has(each)).length, 0);
  });

  test("of nothing, of a line and beside the picture it covers nothing", () => {
    for (const points of [[], [[1, 1]], [[1, 1], [5, 1], [3, 1]], [[-9, -9], [-5, -9], [-7, -3]]] as Point[][])
      assert.deepEqual(fillOutline(points, 9, 9), []);
  });
});

function winds([x, y]: Point, outline: Point[]): boolean {
  let turns = 0;
  outline.forEach(([x0, y0], i) => {
    const [x1, y1] = outline[(i + 1) % outline.length]!;
    const crosses = y0 <= y !== y1 <= y && x < x0 + ((y - y0) / (y1 - y0)) * (x1 - x0);
    if (crosses) turns += y1 > y0 ? 1 : -1;
  });
  return turns !== 0;
}

describe("pieces", () => {
  test("they are what a flood fill finds, in the order of their first pixels", () => {
    const random = chance(7);
    for (let n = 0; n < 40; n++) {
      const [columns, rows] = [1 + Math.floor(12 * random()), 1 + Math.floor(9 * random())];
      const labels = { columns, rows, data: Uint16Array.from({ length: columns * rows }, () => Math.floor(3 * random())) };
      const { pieces, starts } = findPieces(labels);
      assert.deepEqual(pieces.map(({ label, pixels, root }) => [label, pixels, starts[root]]), flooded(labels));
      for (const label of [0, 1, 2])
        assert.deepEqual(findPieces(labels, label).pieces.map((each) => each.pixels), pieces.filter((each) => each.label === label).map((each) => each.pixels));
    }
  });

  test("a name stands within its part, near the middle", () => {
    const labels = picture("aaaaaaaa", "abbbbbba", "abaaaaba", "abbbbbba", "aaaaaaaa");
    for (const [label, { pixels, at }] of findPlaces(labels)) {
      assert.equal(labelAt(labels, ...at), label);
      assert.equal(pixels, labels.data.filter((each) => each === label).length);
    }
    assert.deepEqual(findPlaces(picture(...Array<string>(9).fill("aaaaa"))).get(0)!.at, [2.5, 4.5]);
  });

  test("neighbours touch along a side, not at a corner or around the rim", () => {
    const labels = picture("abba", "bccd", "eeef");
    assert.deepEqual([...findNeighbours(labels, 0)], [1, 3]);
    assert.deepEqual([...findNeighbours(labels, 2)].sort(), [1, 3, 4]);
  });
});

function flooded({ columns, data }: Labels): number[][] {
  const seen = new Set<number>();
  const indices: number[][] = [];
  for (let at = 0; at < data.length; at++) {
    if (seen.has(at)) continue;
    const todo = [at];
    seen.add(at);
    for (const here of todo)
      for (const near of [here % columns ? here - 1 : -1, (here + 1) % columns ? here + 1 : -1, here - columns, here + columns])
        if (near >= 0 && near < data.length && data[near] === data[at] && !seen.has(near)) todo.push(near), seen.add(near);
    indices.push([data[at]!, todo.length, at]);
  }
  return indices;
}

test("a mask is what its runs say", () => {
  const spans = toSpans({ box: [2, 3, 4, 3], runs: [3, 6, 2, 1] });
  assert.deepEqual(spans, [[3, 5, 6], [4, 2, 6], [5, 2, 3], [5, 5, 6]]);
  const mask = new Mask(10, 10);
  mask.put(spans, true);
  assert.deepEqual([...mask.spans()], spans);
  mask.clear();
  assert.ok(mask.data.every((each) => !each));
});
