import assert from "node:assert/strict";
import { describe, test } from "node:test";
import type { ToolRequests } from "../../src/panels/parts/controls/tools";
import { announce, describe as describePart, helpOf, textOf } from "../../src/panels/parts/editor/speech";
import { type EditorEvents, EditorState } from "../../src/panels/parts/editor/state";
import type { Point } from "../../src/panels/parts/pixels/labels";
import { drawn, part, picture } from "./pictures";

const NONE: ToolRequests = { propose: async () => null, snap: async (outline) => [...outline] };
const NAMES = ["pixels", "parts", "survey", "selected", "reordered", "tool", "width", "options", "crosshair", "entered", "pen", "notice", "where"] as const;

/** An editor's state of a picture in letters, what it told, and what it announced. */
function editor(lines: string[], requests = NONE) {
  const labels = picture(...lines);
  const parts = [...new Set(labels.data)].sort().map((label) => part(label, { name: `part ${label}` }));
  const heights = { by: "depth", round_m: 0.0012345, bulge_m: 0, detail_m: 0 } as const;
  const state = new EditorState({ labels, parts, top_m: 0.004, digest: "d", heights, title: " A ", language: "", divided: true, file: "", beside: "" }, requests);
  const told: (keyof EditorEvents)[] = [];
  const said: string[] = [];
  for (const name of NAMES) state.events.on(name, () => void told.push(name));
  announce(state, (text) => void said.push(String(text)));
  state.survey();
  told.length = 0;
  return { state, told, said, draw: () => drawn(labels) };
}

const strokeOf = async (state: EditorState, ...points: Point[]): Promise<void> => {
  state.tools.put(points[0]!);
  for (const each of points.slice(1)) state.tools.move(each);
  await state.tools.lift();
  state.lifted();
};

describe("editor state", () => {
  test("people know a part by its number from 1, as everywhere", () => {
    const { state } = editor(["ab", "ab"]);
    assert.deepEqual([0, 1].map((label) => state.numberOf(label)), [1, 2]);
  });

  test("is saved at first, with a brush of a fortieth of the picture", () => {
    const { state } = editor(Array(2).fill("a".repeat(80) + "b".repeat(80)));
    assert.ok(state.isSaved);
    assert.deepEqual([state.tools.width, state.tools.newPart, state.notice], [4, false, null]);
  });

  test("of a picture of one part paints new parts alone", () => {
    const { state } = editor(["aaaa"]);
    assert.ok(state.tools.newPart);
    state.toggleNewPart();
    assert.deepEqual([state.tools.newPart, state.tools.tool], [true, "brush"]);
  });

  test("tells of a stroke: pixels while it lasts, parts when it ends", async () => {
    const { state, told, draw } = editor(["aaaa", "bbbb"]);
    state.select(1);
    state.use("brush");
    told.length = 0;
    await strokeOf(state, [0.5, 0.5]);
    assert.deepEqual(draw(), ["baaa", "bbbb"]);
    assert.deepEqual(told.filter((name) => name !== "options"), ["pixels", "pixels", "parts"]);
    assert.ok(!state.isSaved);
  });

  test("a complaint stays when the tool is lifted, and goes with the next change", async () => {
    const { state, said } = editor(["aaaa", "bbbb"]);
    state.select(0);
    state.use("brush");
    await strokeOf(state, [0.5, 0.5]);
    assert.deepEqual([state.notice?.word, state.notice?.bad], ["nothingChanged", true]);
    assert.equal(said.at(-1), textOf(state, state.notice!));
    assert.match(said.at(-1)!, /part 0/);
    await strokeOf(state, [0.5, 1.5]);
    assert.equal(state.notice, null);
  });

  test("undo and redo say what they did, also where there is nothing", async () => {
    const { state, draw } = editor(["ab"]);
    const words: string[] = [];
    const step = (which: "undo" | "redo"): void => {
      state.step(which);
      words.push(state.notice!.word);
    };
    state.select(1);
    state.join(0);
    assert.deepEqual(draw(), ["bb"]);
    for (const which of ["undo", "undo", "redo", "redo"] as const) step(which);
    assert.deepEqual(words, ["undone", "nothingToUndo", "redone", "nothingToRedo"]);
    assert.deepEqual(draw(), ["bb"]);
  });

  test("undo waits for the tool, for the program and for a save", () => {
    const { state, draw } = editor(["ab"]);
    state.select(1);
    state.join(0);
    for (const busy of [{ down: true }, { busy: true }]) {
      Object.assign(state.tools, busy);
      state.step("undo");
      Object.assign(state.tools, { down: false, busy: false });
    }
    state.saving = true;
    state.step("undo");
    assert.deepEqual(draw(), ["bb"]);
    state.saving = false;
    state.step("undo");
    assert.deepEqual(draw(), ["ab"]);
  });

  test("cancel gives up the stroke, then the proposal, then nothing", () => {
    const { state, draw } = editor(["aaaa", "bbbb"]);
    state.drawing.propose({ box: [0, 0, 2, 1], runs: [0, 2] });
    state.tools.tool = "lasso";
    state.tools.put([0, 0]);
    assert.deepEqual([state.cancel(), state.drawing.proposed !== null], [true, true]);
    assert.deepEqual([state.cancel(), state.drawing.proposed], [true, null]);
    assert.equal(state.cancel(), false);
    assert.deepEqual(draw(), ["aaaa", "bbbb"]);
  });

  test("the crosshair starts in the selected part, stays in the picture and names the parts it enters", () => {
    const { state, said } = editor(["aaabbb", "aaabbb", "aaabbb"]);
    state.select(0);
    const [x, y] = state.placeCrosshair();
    assert.ok(x < 3 && y < 3, `${x} ${y}`);
    state.moveCrosshair(3, 0);
    assert.equal(said.at(-1), "part 1");
    state.moveCrosshair(99, 99);
    assert.deepEqual(state.crosshair, [5.5, 2.5]);
    state.tellWhere();
    assert.deepEqual(state.notice, { word: "where", values: { x: 92, y: 83 }, label: 1, bad: false });
    assert.equal(said.at(-1), "92 % across, 83 % down: part 1");
  });

  test("the pen is put down and lifted by the same key, and says so", async () => {
    const { state, said, draw } = editor(["aaaa", "bbbb"]);
    state.select(1);
    state.use("brush");
    state.crosshair = [0.5, 0.5];
    await state.pen();
    assert.ok(state.tools.down);
    assert.equal(said.at(-1), "Brush: started.");
    state.moveCrosshair(1, 0);
    await state.pen();
    assert.deepEqual(draw(), ["bbaa", "bbbb"]);
    assert.equal(said.at(-1), "Brush: finished.");
  });

  test("a proposal is announced, and accepted with Enter as a new part unless it is to be added to the selected one", async () => {
    const { state, said, draw } = editor(["aaaa", "bbbb"], { ...NONE, propose: async () => ({ box: [0, 0, 2, 1], runs: [0, 2] }) });
    state.select(1);
    state.use("propose");
    state.crosshair = [0.5, 0.5];
    await state.pen();
    await state.pen();
    assert.equal(helpOf(state).startsWith(said.at(-1)!), true);
    assert.ok(helpOf(state).endsWith("It becomes a new part."));
    state.finish();
    assert.deepEqual(draw(), ["ccaa", "bbbb"]);
    assert.equal(state.drawing.selected, 2);
    state.step("undo");
    for (const expected of [["bbaa", "bbbb"], ["ccaa", "bbbb"]]) {
      state.select(1);
      await strokeOf(state, [0.5, 0.5]);
      state.tools.addsTo = expected[0] === "bbaa";
      if (state.tools.addsTo) assert.ok(helpOf(state).endsWith("It is added to: part 1."));
      state.finish();
      assert.deepEqual(draw().map((line) => line.replaceAll(/[d-z]/g, "c")), expected, "the next one is a new part again");
      state.step("undo");
    }
  });

  test("the program's own parts are begun with, unless something is drawn, and closing loses nothing then", () => {
    const { state, said, draw } = editor(["aaaa"]);
    state.begin({ labels: Uint16Array.from([0, 0, 1, 1]), heights_m: [0.001, 0.002] });
    assert.deepEqual(draw(), ["bbcc"]);
    assert.ok(state.isSaved && said.at(-1)!.startsWith("2 parts are proposed"));
    state.step("undo");
    assert.deepEqual([draw(), state.tools.newPart], [["aaaa"], true]);
    state.drawing.begin(null);
    state.drawing.paint([[0, 0, 1]]);
    state.drawing.end();
    assert.ok(!state.isSaved, "as many steps, and one of them is the person's");
    state.begin({ labels: Uint16Array.from([0, 0, 1, 1]), heights_m: [0.001, 0.002] });
    assert.equal(state.drawing.parts.length, 2);
  });

  test("slivers that go are said", async () => {
    const lines = Array.from({ length: 40 }, (_, row) => (row % 39 ? `a${"b".repeat(38)}a` : "a".repeat(40)));
    const inner = Array.from({ length: 37 }).flatMap(() => [0, 38]);
    const { state, said } = editor(lines, { ...NONE, propose: async () => ({ box: [1, 1, 38, 37], runs: inner }) });
    state.drawing.set(new Map([[1, { name: "" }]]));
    state.use("propose");
    state.drawing.limits.width = 3;
    await strokeOf(state, [5, 5]);
    state.finish();
    assert.equal(said.at(-1), "A sliver, too small for a finger, went to the part around it. Undo takes that back.");
  });

  test("a proposed region is made larger and smaller by the keys of the brush", async () => {
    const levels: number[] = [];
    const propose: ToolRequests["propose"] = async (_, __, { level }) => {
      levels.push(level);
      return { box: [0, 0, level > 0.65 ? 3 : 2, 1], runs: [0, level > 0.65 ? 3 : 2] };
    };
    const { state, said, draw } = editor(["aaaa", "bbbb"], { ...NONE, propose });
    const { width } = state.tools;
    state.select(1);
    state.use("propose");
    await strokeOf(state, [0.5, 0.5]);
    for (const by of [1, 1, 1, 1, 1, -1] as const) {
      state.resizeBrush(by);
      await new Promise(setImmediate);
    }
    assert.deepEqual(levels, [0.6, 0.7, 0.8, 0.9, 0.95, 0.95, 0.85]);
    assert.equal(state.tools.width, width);
    assert.equal(helpOf(state).startsWith(said.at(-1)!), true);
    state.finish();
    assert.deepEqual(draw(), ["ccca", "bbbb"]);
    state.resizeBrush(1);
    assert.equal(levels.length, 7, "the brush again");
    assert.ok(state.tools.width > width);
  });

  test("a request that fails is shown", async () => {
    const { state } = editor(["aaaa", "bbbb"], { ...NONE, propose: () => Promise.reject(new Error("no memory")) });
    state.use("propose");
    await strokeOf(state, [0.5, 0.5]);
    assert.deepEqual(state.notice, { word: "failed", values: { why: "no memory" }, bad: true });
  });

  test("the brush grows and shrinks by at least a pixel, up to the picture's longer side", () => {
    const { state } = editor(Array(2).fill("a".repeat(30)));
    const widths = ([1, 1, 1, 1, -1, -1, -1, -1, -1, -1] as const).map((by) => (state.resizeBrush(by), state.tools.width));
    assert.deepEqual(widths, [2, 3, 4, 5, 4, 3, 2, 1, 1, 1]);
    for (let n = 0; n < 30; n++) state.resizeBrush(1);
    assert.equal(state.tools.width, 30);
  });

  test("the update holds opened parts by their numbers; a new part has none until it is saved", () => {
    const { state } = editor(["aabb"]);
    state.drawing.set(new Map([[0, { height_m: 0.002, automatic: false }], [1, { automatic: true, material: "wood" }]]));
    const before = state.update();
    assert.deepEqual([before.heights_m, before.materials], [[0.002, null], [null, "wood"]]);
    state.drawing.begin(null);
    state.drawing.paint([[0, 0, 1]]);
    state.drawing.end();
    assert.deepEqual([state.update().heights_m, state.isFelt(2)], [[0.002, null], false]);
    const { parts, history } = state.drawing;
    state.markSaved({ file: "p.yaml", digest: "e", numbers: { 0: [1], 1: [2], 2: [0] } }, parts, history.length);
    assert.deepEqual(state.update(), state.base);
    assert.deepEqual([state.update().heights_m, state.isFelt(2), state.isSaved, state.digest], [[0.003, 0.002, null], true, true, "e"]);
  });

  test("title and language are trimmed, the shape rounded, and heights given where no part finds its own", () => {
    const { state } = editor(["ab"]);
    assert.deepEqual(state.savedDetails, { heights: { by: "given", round_m: 0.00123, bulge_m: 0, detail_m: 0 }, title: "A", language: "en" });
    state.drawing.set(new Map([[0, { automatic: true }]]));
    assert.equal(state.savedDetails.heights.by, "depth");
    state.drawing.history.markSaved();
    state.setDetails({ title: "B" });
    assert.ok(!state.isSaved);
  });

  test("a selected part is described by name, height, size and place", () => {
    const { state, said } = editor(["aabb"]);
    state.drawing.set(new Map([[1, { height_m: 0.001 }]]));
    state.select(1);
    assert.equal(said.at(-1), describePart(state, 1));
    assert.equal(said.at(-1), "part 1, 1.00 mm, 50 % of the picture, right.");
    assert.equal(describePart(state, 7), "");
  });
});
