import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { Drawing, Full } from "../../src/panels/parts/drawing/drawing";
import { frontToBack, reorder, spread } from "../../src/panels/parts/drawing/order";
import { stroke } from "../../src/panels/parts/pixels/brush";
import type { Point } from "../../src/panels/parts/pixels/labels";
import { findPieces } from "../../src/panels/parts/pixels/pieces";
import { fillOutline } from "../../src/panels/parts/pixels/polygon";
import { chance, drawing, drawn, part, picture } from "./pictures";

describe("order", () => {
  test("the highest is the foremost", () => {
    const parts = [part(0), part(1, { height_m: 0.003 }), part(2, { height_m: 0.001 })];
    assert.deepEqual(frontToBack(parts).map((each) => each.label), [1, 2, 0]);
  });

  test("a part that is moved takes its place, and the heights that were there stay", () => {
    const parts = [part(0, { height_m: 0.001 }), part(1, { height_m: 0.003 }), part(2, { height_m: 0.002 })];
    assert.deepEqual(reorder(parts, 0, 2, 0.004).map((each) => [each.label, each.height_m]), [[0, 0.003], [1, 0.002], [2, 0.001]]);
    assert.deepEqual(reorder(parts, 1, 1, 0.004).map((each) => each.label), [1, 2, 0], "no farther than the front");
  });

  test("equal heights are spread so that each is felt, and none leaves the workspace", () => {
    assert.deepEqual(spread([0, 0, 0], 0.004), [0, 0.0005, 0.001]);
    assert.deepEqual(spread([0, 0.004, 0.004], 0.004), [0, 0.0035, 0.004]);
    for (const count of [1, 2, 40]) {
      const indices = spread(Array<number>(count).fill(0.002), 0.004);
      assert.ok(indices.every((each, i) => each >= 0 && each <= 0.004 && (!i || each > indices[i - 1]!)), `${indices}`);
    }
    assert.deepEqual(spread([0, 0], 0), [0, 0]);
  });
});

describe("drawing", () => {
  test("a new part stands before what it was painted on, and is chosen", () => {
    const it = drawing(["aaaa", "aaaa", "bbbb"]);
    it.set(new Map([[0, { height_m: 0.0035 }]]));
    it.begin(null);
    it.paint([[0, 0, 2], [1, 0, 2]]);
    assert.ok(it.end());
    assert.deepEqual(drawn(it.labels), ["ccaa", "ccaa", "bbbb"]);
    assert.deepEqual([it.selected, it.part(2)!.height_m, it.share(2)], [2, 0.004, 4 / 12]);
  });

  test("a part that is painted over is gone, and comes back", () => {
    const it = drawing(["aab", "aab"]);
    it.begin(0);
    it.paint([[0, 2, 3], [1, 2, 3]]);
    it.end();
    assert.deepEqual(it.parts.map((each) => each.label), [0]);
    it.undo();
    assert.deepEqual(it.parts.map((each) => each.name), ["part 0", "part 1"]);
  });

  test("a stroke that changes nothing is none, and one that is given up leaves nothing", () => {
    const it = drawing(["aab"]);
    it.begin(0);
    it.paint([[0, 0, 2]]);
    assert.ok(!it.end() && !it.history.canUndo);
    it.begin(null);
    it.paint([[0, 0, 3]]);
    it.cancel();
    assert.deepEqual(drawn(it.labels), ["aab"]);
  });

  test("parts are joined", () => {
    const it = drawing(["abc", "abc"]);
    assert.ok(it.join(1, 2) && !it.join(1, 2) && !it.join(2, 2));
    assert.deepEqual(drawn(it.labels), ["acc", "acc"]);
    assert.deepEqual([it.selected, it.parts.length], [2, 2]);
  });

  test("a part is cut by a line, every pixel of it stays a part's, and a line that does not cross cuts nothing", () => {
    const it = drawing(["aaaaaa", "aaaaaa", "aaaaaa", "bbbbbb"]);
    assert.ok(!it.split(0, [[1.5, 0.5], [2.5, 1.5]]) && !it.history.canUndo);
    assert.deepEqual(drawn(it.labels), ["aaaaaa", "aaaaaa", "aaaaaa", "bbbbbb"]);
    assert.ok(it.split(0, [[0.5, -3], [3.5, 9]]), "also from beside it to beside it");
    assert.deepEqual([...new Set(it.labels.data)].sort(), [0, 1, 2]);
    assert.equal(findPieces(it.labels).pieces.length, 3);
    assert.equal(drawn(it.labels)[3], "bbbbbb");
    assert.deepEqual(it.parts.map((each) => each.name), ["part 0", "part 1", "part 0 2"]);
    it.undo();
    assert.deepEqual(drawn(it.labels), ["aaaaaa", "aaaaaa", "aaaaaa", "bbbbbb"]);
  });

  test("pixels of a line along the rim of the picture do not go to a part at the rim across", () => {
    const it = drawing(["aaaaaaa", "aaaaaaa", "aaaaaaa", "aaaaaaa"]);
    assert.ok(it.split(0, [[0.5, 0.5], [0.5, 3.5], [4.5, 3.5], [4.5, 0.5]]));
    assert.equal(findPieces(it.labels).pieces.length, 2);
  });

  test("pieces of a part become parts of their own, the largest stays it, and slivers go to what is most around them", () => {
    const it = drawing(["aabaaa", "aabbba", "bbbcbb", "abcbbb"], { pixels: 2, width: 0 });
    assert.deepEqual([...it.scattered()], [[0, [4, 4, 1]], [2, [1, 1]]].map((each) => each as [number, number[]]));
    assert.equal(it.tidy(), 2, "a pixel of a, and one of c; the other c is all that is left of it");
    assert.deepEqual(drawn(it.labels), ["aabaaa", "aabbba", "bbbcbb", "bbbbbb"]);
    it.settle();
    assert.equal(it.scattered().size, 0);
    const { data } = it.labels;
    assert.equal(data.filter((each) => each === 0).length, 4);
    assert.equal(it.parts.length, 4);
    assert.ok(it.parts.some((each) => each.name === "part 0 2"));
    it.undo();
    it.undo();
    assert.deepEqual(drawn(it.labels), ["aabaaa", "aabbba", "bbbcbb", "abcbbb"]);
    it.settle();
    assert.equal(it.parts.length, 6);
  });

  test("a picture of one part is divided in one step, which undo takes back to nothing", () => {
    const it = drawing(["aaaa", "aaaa"]);
    it.divide(Uint16Array.from([0, 0, 1, 1, 0, 2, 2, 1]), [0.001, 0.009, 0.002]);
    assert.deepEqual(drawn(it.labels), ["bbcc", "bddc"]);
    assert.deepEqual(it.parts.map(({ label, name, height_m }) => [label, name, height_m]), [[1, "", 0.001], [2, "", 0.004], [3, "", 0.002]]);
    assert.equal(it.selected, 2);
    it.undo();
    assert.deepEqual([drawn(it.labels), it.parts.length, it.history.canUndo], [["aaaa", "aaaa"], 1, false]);
  });

  test("slivers that an accepted proposal leaves go to their surroundings in the same step, but no named part goes", () => {
    const lines = ["aaaaaaaa", "abbbbaaa", "abbbbaaa", "abbbbaaa", "aaaaaaaa"];
    const propose = (it: Drawing): void => it.propose({ box: [2, 1, 3, 3], runs: [0, 9] });
    const it = drawing(lines, { pixels: 4, width: 0 });
    it.set(new Map([[1, { name: "" }]]));
    propose(it);
    assert.ok(it.accept(null));
    assert.equal(it.given, 1);
    assert.deepEqual(drawn(it.labels), ["aaaaaaaa", "aacccaaa", "aacccaaa", "aacccaaa", "aaaaaaaa"]);
    it.undo();
    assert.deepEqual(drawn(it.labels), lines, "one step");
    it.undo();
    propose(it);
    it.accept(null);
    assert.deepEqual([drawn(it.labels)[1], it.given], ["abdddaaa", 0], "it has a name");
  });

  test("a sliver is what is thin, however long", () => {
    const it = drawing(["aaaaaaaaaaaa", "bbbbbbbbbbbb", "aaaaaaaaaaaa", "aaaaaaaaaaaa", "bbbbbbbbbbbb", "bbbbbbbbbbbb", "bbbbbbbbbbbb"], { pixels: 0, width: 1.2 });
    assert.equal(it.tidy(), 1, "the first row goes to the second, which is wide enough then");
    assert.deepEqual(drawn(it.labels).map((each) => each[0]).join(""), "bbaabbb");
  });

  test("what was proposed is corrected, accepted as a part, or thrown away", () => {
    const it = drawing(["aaaaa", "aaaaa", "aaaaa"]);
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
    const it = drawing(["ab"]);
    for (const height_m of [0.001, 0.002, 0.003]) it.set(new Map([[1, { height_m }]]), "height 1");
    it.history.endGesture();
    it.set(new Map([[1, { height_m: 0.004 }]]), "height 1");
    it.undo();
    assert.equal(it.part(1)!.height_m, 0.003);
    it.history.markSaved();
    it.set(new Map([[1, { name: "b" }]]));
    assert.ok(!it.history.isSaved);
    it.undo();
    assert.ok(it.history.isSaved);
    it.undo();
    assert.equal(it.part(1)!.height_m, 0);
    it.set(new Map([[1, { name: "c" }]]));
    assert.ok(!it.history.isSaved, "as many steps, but others");
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
  const it = drawing(["aaaaaaaaaaaa", "aaaabbbbaaaa", "aaaabbbbcccc", "ddddbbbbcccc", "ddddddddcccc", "ddddddddcccc"]);
  const any = (): number => it.parts[upTo(it.parts.length)]!.label;
  const place = (): Point => [16 * random() - 2, 10 * random() - 2];
  const acts: (() => void)[] = [
    () => (it.begin(random() < 0.5 ? any() : null), it.paint(stroke(place(), place(), 1 + 4 * random(), 12, 6)), it.paint(stroke(place(), place(), 2, 12, 6)), it.end()),
    () => (it.begin(any()), it.paint(fillOutline([place(), place(), place()], 12, 6)), it.cancel()),
    () => void it.join(any(), any()),
    () => void it.split(any(), [place(), place(), place()]),
    () => (random() < 0.5 ? it.settle() : void it.tidy()),
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
