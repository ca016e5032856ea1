import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { stroke } from "../src/panels/parts/pixels/brush";
import { Drawing, Full, type Part } from "../src/panels/parts/drawing/drawing";
import { type Labels, labelAt, type Point, type Span } from "../src/panels/parts/pixels/labels";
import { Mask, spansOf } from "../src/panels/parts/pixels/mask";
import { fromFront, moved, spread } from "../src/panels/parts/drawing/order";
import { neighboursOf, piecesOf, placesOf } from "../src/panels/parts/pixels/pieces";
import { filled } from "../src/panels/parts/pixels/polygon";
import { borders } from "../src/panels/parts/board/borders";
import { KEYS, TOOL_KEYS } from "../src/panels/parts/editor/keys";
import { type Felt, Live } from "../src/panels/parts/editor/live_update";
import { Sight } from "../src/panels/parts/board/viewport";
import { SHORTCUTS } from "../src/shortcuts";

const part = (label: number, more: Partial<Part> = {}): Part => ({ label, name: "", height_m: 0, material: null, automatic: false, ...more });

/** A picture drawn in letters: each is a part. */
function picture(...lines: string[]): Labels {
  const [columns, rows] = [lines[0]!.length, lines.length];
  return { columns, rows, data: Uint16Array.from(lines.join(""), (each) => each.charCodeAt(0) - 97) };
}

const drawn = ({ columns, data }: Labels): string[] =>
  Array.from({ length: data.length / columns }, (_, row) =>
    String.fromCharCode(...data.subarray(row * columns, (row + 1) * columns).map((each) => each + 97)),
  );

function drawing(...lines: string[]): Drawing {
  const labels = picture(...lines);
  return new Drawing(labels, [...new Set(labels.data)].sort().map((label) => part(label, { name: `part ${label}` })), 0.004);
}

const pixels = (spans: Iterable<Span>): Set<string> =>
  new Set([...spans].flatMap(([row, from, to]) => Array.from({ length: to - from }, (_, i) => `${from + i} ${row}`)));

/** Numbers from 0 to 1, the same each time. */
function chance(seed: number): () => number {
  return () => {
    seed = (seed * 1664525 + 1013904223) >>> 0;
    return seed / 2 ** 32;
  };
}

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
    assert.equal(piecesOf(labels, 1).pieces.length, 1);
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
    const found = pixels(filled(star, 20, 20));
    for (let y = 0; y < 20; y++)
      for (let x = 0; x < 20; x++) assert.equal(found.has(`${x} ${y}`), winds([x + 0.5, y + 0.5], star), `${x} ${y}`);
    assert.ok(found.has("10 9"), "its middle, which it goes around twice");
  });

  test("two outlines that share an edge share no pixel and leave none", () => {
    const left = pixels(filled([[0, 0], [3.3, 0], [6.1, 10], [0, 10]], 10, 10));
    const right = pixels(filled([[3.3, 0], [10, 0], [10, 10], [6.1, 10]], 10, 10));
    assert.equal(left.size + right.size, 100);
    assert.equal([...left].filter((each) => right.has(each)).length, 0);
  });

  test("of nothing, of a line and beside the picture it covers nothing", () => {
    for (const points of [[], [[1, 1]], [[1, 1], [5, 1], [3, 1]], [[-9, -9], [-5, -9], [-7, -3]]] as Point[][])
      assert.deepEqual(filled(points, 9, 9), []);
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
      const { pieces, starts } = piecesOf(labels);
      assert.deepEqual(pieces.map(({ label, pixels, root }) => [label, pixels, starts[root]]), flooded(labels));
      for (const label of [0, 1, 2])
        assert.deepEqual(piecesOf(labels, label).pieces.map((each) => each.pixels), pieces.filter((each) => each.label === label).map((each) => each.pixels));
    }
  });

  test("a name stands within its part, near the middle", () => {
    const labels = picture("aaaaaaaa", "abbbbbba", "abaaaaba", "abbbbbba", "aaaaaaaa");
    for (const [label, { pixels, at }] of placesOf(labels)) {
      assert.equal(labelAt(labels, ...at), label);
      assert.equal(pixels, labels.data.filter((each) => each === label).length);
    }
    assert.deepEqual(placesOf(picture(...Array<string>(9).fill("aaaaa"))).get(0)!.at, [2.5, 4.5]);
  });

  test("neighbours touch along a side, not at a corner or around the rim", () => {
    const labels = picture("abba", "bccd", "eeef");
    assert.deepEqual([...neighboursOf(labels, 0)], [1, 3]);
    assert.deepEqual([...neighboursOf(labels, 2)].sort(), [1, 3, 4]);
  });
});

function flooded({ columns, data }: Labels): number[][] {
  const seen = new Set<number>();
  const found: number[][] = [];
  for (let at = 0; at < data.length; at++) {
    if (seen.has(at)) continue;
    const todo = [at];
    seen.add(at);
    for (const here of todo)
      for (const near of [here % columns ? here - 1 : -1, (here + 1) % columns ? here + 1 : -1, here - columns, here + columns])
        if (near >= 0 && near < data.length && data[near] === data[at] && !seen.has(near)) todo.push(near), seen.add(near);
    found.push([data[at]!, todo.length, at]);
  }
  return found;
}

describe("order", () => {
  test("the highest is the foremost", () => {
    const parts = [part(0), part(1, { height_m: 0.003 }), part(2, { height_m: 0.001 })];
    assert.deepEqual(fromFront(parts).map((each) => each.label), [1, 2, 0]);
  });

  test("a part that is moved takes its place, and the heights that were there stay", () => {
    const parts = [part(0, { height_m: 0.001 }), part(1, { height_m: 0.003 }), part(2, { height_m: 0.002 })];
    assert.deepEqual(moved(parts, 0, 2, 0.004).map((each) => [each.label, each.height_m]), [[0, 0.003], [1, 0.002], [2, 0.001]]);
    assert.deepEqual(moved(parts, 1, 1, 0.004).map((each) => each.label), [1, 2, 0], "no farther than the front");
  });

  test("equal heights are spread so that each is felt, and none leaves the workspace", () => {
    assert.deepEqual(spread([0, 0, 0], 0.004), [0, 0.0005, 0.001]);
    assert.deepEqual(spread([0, 0.004, 0.004], 0.004), [0, 0.0035, 0.004]);
    for (const count of [1, 2, 40]) {
      const made = spread(Array<number>(count).fill(0.002), 0.004);
      assert.ok(made.every((each, i) => each >= 0 && each <= 0.004 && (!i || each > made[i - 1]!)), `${made}`);
    }
    assert.deepEqual(spread([0, 0], 0), [0, 0]);
  });
});

describe("drawing", () => {
  test("a new part stands before what it was painted on, and is chosen", () => {
    const it = drawing("aaaa", "aaaa", "bbbb");
    it.set(new Map([[0, { height_m: 0.0035 }]]));
    it.begin(null);
    it.paint([[0, 0, 2], [1, 0, 2]]);
    assert.ok(it.end());
    assert.deepEqual(drawn(it.labels), ["ccaa", "ccaa", "bbbb"]);
    assert.deepEqual([it.selected, it.part(2)!.height_m, it.share(2)], [2, 0.004, 4 / 12]);
  });

  test("a part that is painted over is gone, and comes back", () => {
    const it = drawing("aab", "aab");
    it.begin(0);
    it.paint([[0, 2, 3], [1, 2, 3]]);
    it.end();
    assert.deepEqual(it.parts.map((each) => each.label), [0]);
    it.undo();
    assert.deepEqual(it.parts.map((each) => each.name), ["part 0", "part 1"]);
  });

  test("a stroke that changes nothing is none, and one that is given up leaves nothing", () => {
    const it = drawing("aab");
    it.begin(0);
    it.paint([[0, 0, 2]]);
    assert.ok(!it.end() && !it.canUndo);
    it.begin(null);
    it.paint([[0, 0, 3]]);
    it.cancel();
    assert.deepEqual(drawn(it.labels), ["aab"]);
  });

  test("parts are joined", () => {
    const it = drawing("abc", "abc");
    assert.ok(it.join(1, 2) && !it.join(1, 2) && !it.join(2, 2));
    assert.deepEqual(drawn(it.labels), ["acc", "acc"]);
    assert.deepEqual([it.selected, it.parts.length], [2, 2]);
  });

  test("a part is cut by a line, every pixel of it stays a part's, and a line that does not cross cuts nothing", () => {
    const it = drawing("aaaaaa", "aaaaaa", "aaaaaa", "bbbbbb");
    assert.ok(!it.split(0, [[1.5, 0.5], [2.5, 1.5]]) && !it.canUndo);
    assert.deepEqual(drawn(it.labels), ["aaaaaa", "aaaaaa", "aaaaaa", "bbbbbb"]);
    assert.ok(it.split(0, [[0.5, -3], [3.5, 9]]), "also from beside it to beside it");
    assert.deepEqual([...new Set(it.labels.data)].sort(), [0, 1, 2]);
    assert.equal(piecesOf(it.labels).pieces.length, 3);
    assert.equal(drawn(it.labels)[3], "bbbbbb");
    assert.deepEqual(it.parts.map((each) => each.name), ["part 0", "part 1", "part 0 2"]);
    it.undo();
    assert.deepEqual(drawn(it.labels), ["aaaaaa", "aaaaaa", "aaaaaa", "bbbbbb"]);
  });

  test("pixels of a line along the rim of the picture do not go to a part at the rim across", () => {
    const it = drawing("aaaaaaa", "aaaaaaa", "aaaaaaa", "aaaaaaa");
    assert.ok(it.split(0, [[0.5, 0.5], [0.5, 3.5], [4.5, 3.5], [4.5, 0.5]]));
    assert.equal(piecesOf(it.labels).pieces.length, 2);
  });

  test("pieces of a part become parts of their own, the largest stays it, and crumbs go to what is around them", () => {
    const it = drawing("aabaaa", "aabbba", "bbbcbb", "acbbbb");
    assert.deepEqual([...it.scattered()], [[0, [4, 4, 1]], [2, [1, 1]]].map((each) => each as [number, number[]]));
    it.settle(2);
    assert.equal(it.scattered().size, 0);
    const { data } = it.labels;
    assert.equal(data.filter((each) => each === 0).length, 4);
    assert.equal(it.parts.length, 4);
    assert.ok(it.parts.some((each) => each.name === "part 0 2"));
    it.undo();
    assert.deepEqual(drawn(it.labels), ["aabaaa", "aabbba", "bbbcbb", "acbbbb"]);
    it.settle(0);
    assert.equal(it.parts.length, 6);
  });

  test("what was proposed is corrected, accepted as a part, or thrown away", () => {
    const it = drawing("aaaaa", "aaaaa", "aaaaa");
    it.propose({ box: [1, 0, 3, 2], runs: [1, 2, 1, 2] });
    it.correct([[2, 0, 5]], true);
    it.correct([[0, 3, 4], [2, 1, 2]], false);
    assert.deepEqual(drawn(it.labels), Array(3).fill("aaaaa"), "nothing is painted yet");
    assert.ok(it.accept(null));
    assert.deepEqual(drawn(it.labels), ["aabaa", "aabba", "babbb"]);
    it.propose({ box: [0, 0, 1, 1], runs: [0, 1] });
    it.discard();
    assert.ok(!it.accept(null));
    assert.deepEqual(drawn(it.labels), ["aabaa", "aabba", "babbb"]);
  });

  test("a drag is one step, and saved is what is as it was saved", () => {
    const it = drawing("ab");
    for (const height_m of [0.001, 0.002, 0.003]) it.set(new Map([[1, { height_m }]]), "height 1");
    it.endGesture();
    it.set(new Map([[1, { height_m: 0.004 }]]), "height 1");
    it.undo();
    assert.equal(it.part(1)!.height_m, 0.003);
    it.keep();
    it.set(new Map([[1, { name: "b" }]]));
    assert.ok(!it.saved);
    it.undo();
    assert.ok(it.saved);
    it.undo();
    assert.equal(it.part(1)!.height_m, 0);
    it.set(new Map([[1, { name: "c" }]]));
    assert.ok(!it.saved, "as many steps, but others");
  });

  test("there is an end to the numbers", () => {
    const it = new Drawing(picture("ab"), [part(0), part(0xfffe)], 0.004);
    assert.throws(() => it.begin(null), Full);
  });

  test("whatever is done, undo takes it back to the bit and redo brings it again", () => {
    for (let seed = 1; seed <= 25; seed++) anything(seed);
  });
});

/** Do anything, step by step; go back and forth at random; and all the way back and forth in the end. */
function anything(seed: number): void {
  const random = chance(seed);
  const upTo = (most: number): number => Math.floor(most * random());
  const it = drawing("aaaaaaaaaaaa", "aaaabbbbaaaa", "aaaabbbbcccc", "ddddbbbbcccc", "ddddddddcccc", "ddddddddcccc");
  const any = (): number => it.parts[upTo(it.parts.length)]!.label;
  const place = (): Point => [16 * random() - 2, 10 * random() - 2];
  const acts: (() => void)[] = [
    () => (it.begin(random() < 0.5 ? any() : null), it.paint(stroke(place(), place(), 1 + 4 * random(), 12, 6)), it.paint(stroke(place(), place(), 2, 12, 6)), it.end()),
    () => (it.begin(any()), it.paint(filled([place(), place(), place()], 12, 6)), it.cancel()),
    () => void it.join(any(), any()),
    () => void it.split(any(), [place(), place(), place()]),
    () => it.settle(upTo(4)),
    () => it.set(new Map([[any(), { name: `n${upTo(99)}`, height_m: 0.004 * random() }]]), random() < 0.5 ? "g" : ""),
    () => it.order(any(), upTo(5) - 2),
    () => (it.propose({ box: [1, 1, 4, 3], runs: [upTo(6), 2 + upTo(4)] }), it.accept(random() < 0.5 ? any() : null)),
    () => void it.undo(),
    () => void it.redo(),
  ];
  const now = (): unknown => [drawn(it.labels), it.parts];
  const first = now();
  for (let n = 0; n < 60; n++) {
    acts[upTo(acts.length)]!();
    assert.equal(it.parts.reduce((sum, each) => sum + it.share(each.label), 0).toFixed(9), "1.000000000");
    assert.deepEqual(new Set(it.labels.data), new Set(it.parts.map((each) => each.label)));
  }
  while (it.redo());
  const last = now();
  while (it.undo());
  assert.deepEqual(now(), first);
  while (it.redo());
  assert.deepEqual(now(), last);
}

test("a mask is what its runs say", () => {
  const spans = spansOf({ box: [2, 3, 4, 3], runs: [3, 6, 2, 1] });
  assert.deepEqual(spans, [[3, 5, 6], [4, 2, 6], [5, 2, 3], [5, 5, 6]]);
  const mask = new Mask(10, 10);
  mask.put(spans, true);
  assert.deepEqual([...mask.spans()], spans);
  mask.clear();
  assert.ok(mask.data.every((each) => !each));
});

describe("sight", () => {
  const seen = (): Sight => {
    const sight = new Sight(400, 300);
    sight.resize(800, 900);
    return sight;
  };

  test("the whole picture is seen at first, in the middle, and still when the board is resized", () => {
    const sight = seen();
    assert.deepEqual([sight.zoom, sight.toBoard([0, 0]), sight.toBoard([400, 300])], [2, [0, 150], [800, 750]]);
    sight.resize(400, 300);
    assert.deepEqual([sight.zoom, sight.toBoard([0, 0])], [1, [0, 0]]);
    sight.nearer(4);
    sight.resize(500, 300);
    assert.equal(sight.zoom, 4);
  });

  test("what is under the pointer stays there, and places lead back", () => {
    const sight = seen();
    const at = sight.toPicture([200, 400]);
    sight.nearer(3, [200, 400]);
    assert.deepEqual(sight.toPicture([200, 400]).map((each) => Math.round(1e6 * each)), at.map((each) => Math.round(1e6 * each)));
    assert.deepEqual(sight.toBoard(sight.toPicture([5, 7])).map((each) => Math.round(1e6 * each) / 1e6), [5, 7]);
  });

  test("a crosshair is brought into sight, and one that is seen moves nothing", () => {
    const sight = seen();
    assert.ok(!sight.reveal([0.5, 0.5]) && !sight.reveal([399.5, 299.5]));
    sight.nearer(8, [400, 450]);
    assert.ok(sight.reveal([399.5, 10.5]));
    const [x, y] = sight.toBoard([399.5, 10.5]);
    assert.ok(x > 0 && x < 800 && y > 0 && y < 900, `${x} ${y}`);
  });
});

test("borders are a dark line beside a light one, the selected part's in the colour of the theme, proposals are dashed", () => {
  (globalThis as { ImageData?: unknown }).ImageData = class {
    data: Uint8ClampedArray;
    constructor(
      readonly width: number,
      readonly height: number,
    ) {
      this.data = new Uint8ClampedArray(4 * width * height);
    }
  };
  const labels = picture(...Array<string>(10).fill("aaaaabbbbbccccc"));
  const sight = new Sight(15, 10);
  sight.resize(15, 10);
  const look = { labels, selected: 2, proposed: null as Mask | null, accent: 7, against: 8, thin: 9, ratio: 0.67 };
  const row = (box = { left: 0, top: 4, right: 15, bottom: 5 }): number[] => [...new Uint32Array(borders(look, sight, box).data.buffer)];
  const [dark, light] = [0xd0000000, 0xe6ffffff];
  const whole = row();
  assert.deepEqual(whole.slice(3, 7), [0, dark, light, 0]);
  assert.equal(whole[9], 8);
  assert.ok(whole.slice(10, 12).every((each) => each === 7));
  assert.deepEqual(row({ left: 4, top: 4, right: 11, bottom: 5 }), whole.slice(4, 11), "a part of it is the same");
  look.proposed = new Mask(15, 10);
  look.proposed.put([[4, 1, 4]], true);
  assert.notDeepEqual(row(), whole);
});

test("what is dragged is sent one at a time, the newest last, and what is felt already is not", async () => {
  const sent: number[] = [];
  const arrive: (() => void)[] = [];
  const at = (height: number): Felt => ({ heights_m: [height], materials: [null], heights: {} });
  const live = new Live(({ heights_m }) => {
    sent.push(heights_m[0]!);
    return new Promise<void>((done) => arrive.push(done));
  }, assert.fail);
  live.feel(at(0), at(0));
  for (const height of [1, 2, 3]) live.feel(at(height), at(0));
  assert.deepEqual(sent, [1]);
  arrive[0]!();
  await new Promise(setImmediate);
  assert.deepEqual(sent, [1, 3]);
  arrive[1]!();
  await new Promise(setImmediate);
  live.feel(at(3), at(0));
  await new Promise(setImmediate);
  assert.deepEqual(sent, [1, 3]);
  live.feel(at(0), at(0));
  assert.deepEqual(sent, [1, 3, 0], "also back to what was opened");
});

test("no key of the editor is one that means something else wherever the focus is", () => {
  const theirs = Object.values(SHORTCUTS).filter(({ where }) => where !== "surface").flatMap(({ keys }) => [...keys] as string[]);
  const own = Object.values(KEYS).flat() as string[];
  assert.deepEqual(own.filter((key) => theirs.includes(key) && key !== "Escape"), []);
  const letters = [...Object.values(TOOL_KEYS), ...KEYS.keyFresh, ...KEYS.keyWidth, ...KEYS.keyWhere, ...KEYS.keyList];
  assert.equal(new Set(letters).size, letters.length);
});
