import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { actionOf, KEYS, TOOL_KEYS } from "../../src/panels/parts/editor/keys";
import type { Update } from "../../src/panels/parts/editor/state";
import { SHORTCUTS } from "kit/shortcuts";

test("every height that is dragged is sent once, and after a failure again", async () => {
  Object.assign(globalThis, { location: { href: "http://127.0.0.1/?token=t" }, sessionStorage: {} });
  const { Saving } = await import("../../src/panels/parts/editor/saving");
  const sent: number[] = [];
  const failed: string[] = [];
  const at = (height: number): Update => ({ heights_m: [height], materials: [null], heights: {} });
  const state = { base: at(0), events: { on: () => undefined }, fail: ({ message }: Error) => failed.push(message) };
  const net = { ask: (_: string, { heights_m }: Update) => (sent.push(heights_m[0]!), heights_m[0] === 9 ? Promise.reject(new Error("high")) : Promise.resolve(null)) };
  const saving = new Saving(state as never, net as never, () => true);
  for (const height of [0, 1, 2, 2, 3, 0]) saving.update(at(height));
  assert.deepEqual(sent, [1, 2, 3, 0], "what is felt already is not sent, and what was opened is");
  for (const height of [9, 9]) {
    saving.update(at(height));
    await new Promise(setImmediate);
  }
  assert.deepEqual([sent.slice(4), failed], [[9, 9], ["high", "high"]]);
});

test("no key of the editor is one that means something else wherever the focus is", () => {
  const theirs = Object.values(SHORTCUTS).filter(({ where }) => where !== "surface").flatMap(({ keys }) => [...keys] as string[]);
  const own = Object.values(KEYS).flat() as string[];
  assert.deepEqual(own.filter((key) => theirs.includes(key) && key !== "Escape"), []);
  const letters = [...Object.values(TOOL_KEYS), ...KEYS.keyFresh, ...KEYS.keyWidth, ...KEYS.keyWhere, ...KEYS.keyList];
  assert.equal(new Set(letters).size, letters.length);
});

describe("key", () => {
  const event = (key: string, more: object = {}) => ({ key, shiftKey: false, ctrlKey: false, altKey: false, repeat: false, ...more });
  const nowhere = { typing: false, onPicture: false, letters: true };

  test("of undo, save and Escape acts everywhere, but a field of text undoes its own letters", () => {
    assert.deepEqual(actionOf("Ctrl+z", event("z"), nowhere), { do: "undo" });
    assert.deepEqual(actionOf("Ctrl+s", event("s"), { ...nowhere, typing: true }), { do: "save" });
    assert.deepEqual(actionOf("Escape", event("Escape"), { ...nowhere, typing: true }), { do: "escape" });
    for (const key of ["Ctrl+z", "Ctrl+Shift+z"]) assert.equal(actionOf(key, event("z"), { ...nowhere, typing: true }), undefined);
  });

  test("that is a letter acts outside of fields, and on the picture alone where letters are off", () => {
    assert.deepEqual(actionOf("b", event("b"), nowhere), { do: "use", tool: "brush" });
    assert.equal(actionOf("b", event("b"), { ...nowhere, typing: true }), undefined);
    assert.equal(actionOf("b", event("b"), { ...nowhere, letters: false }), undefined);
    assert.deepEqual(actionOf("b", event("b"), { typing: false, onPicture: true, letters: false }), { do: "use", tool: "brush" });
  });

  test("that is an arrow moves the crosshair on the picture alone, by Shift a pixel and by Control far", () => {
    const onPicture = { ...nowhere, onPicture: true };
    const paces = [event("ArrowUp"), event("ArrowUp", { shiftKey: true }), event("ArrowUp", { ctrlKey: true })];
    assert.deepEqual(paces.map((each) => actionOf("ArrowUp", each, onPicture)), ["step", "pixel", "far"].map((pace) => ({ do: "move", x: 0, y: -1, pace })));
    assert.equal(actionOf("ArrowUp", event("ArrowUp"), nowhere), undefined);
    assert.equal(actionOf("Alt+ArrowUp", event("ArrowUp", { altKey: true }), onPicture), undefined);
  });

  test("of the pen is heard once while it is held", () => {
    const onPicture = { ...nowhere, onPicture: true };
    assert.deepEqual(actionOf(" ", event(" "), onPicture), { do: "pen" });
    assert.deepEqual(actionOf(" ", event(" ", { repeat: true }), onPicture), { do: "nothing" });
  });
});
