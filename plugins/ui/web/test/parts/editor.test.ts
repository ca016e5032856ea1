import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { actionOf, KEYS, TOOL_KEYS } from "../../src/panels/parts/editor/keys";
import { LiveUpdate, type Update } from "../../src/panels/parts/editor/live_update";
import { SHORTCUTS } from "kit/shortcuts";

test("what is dragged is sent one at a time, the newest last, and what is felt already is not", async () => {
  const sent: number[] = [];
  const arrive: (() => void)[] = [];
  const at = (height: number): Update => ({ heights_m: [height], materials: [null], heights: {} });
  const live = new LiveUpdate(({ heights_m }) => {
    sent.push(heights_m[0]!);
    return new Promise<void>((done) => arrive.push(done));
  }, assert.fail);
  live.send(at(0), at(0));
  for (const height of [1, 2, 3]) live.send(at(height), at(0));
  assert.deepEqual(sent, [1]);
  arrive[0]!();
  await new Promise(setImmediate);
  assert.deepEqual(sent, [1, 3]);
  arrive[1]!();
  await new Promise(setImmediate);
  live.send(at(3), at(0));
  await new Promise(setImmediate);
  assert.deepEqual(sent, [1, 3]);
  live.send(at(0), at(0));
  assert.deepEqual(sent, [1, 3, 0], "also back to what was opened");
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
