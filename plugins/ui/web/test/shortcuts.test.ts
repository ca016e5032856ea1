import assert from "node:assert/strict";
import { test } from "node:test";
import { keyName, SHORTCUTS } from "kit/shortcuts";
import { t } from "../src/panels/help/shortcut_words";

const press = (key: string, held: Partial<KeyboardEvent> = {}): string =>
  keyName({ key, shiftKey: false, ctrlKey: false, altKey: false, metaKey: false, ...held } as KeyboardEvent);

test("no key means two things", () => {
  const keys = Object.values(SHORTCUTS).flatMap(({ keys }) => [...keys]);
  assert.deepEqual(keys.filter((key, at) => keys.indexOf(key) !== at), []);
});

test("every shortcut says what it does, and its keys are written as they are heard", () => {
  for (const [name, { keys }] of Object.entries(SHORTCUTS)) {
    assert.ok(t.has(name), name);
    for (const key of keys) {
      const last = key.length > 1 && key.includes("+") ? key.slice(key.lastIndexOf("+") + 1) : key;
      assert.ok(last.length > 1 || last === last.toLowerCase(), key);
    }
  }
});

test("browsers and screen readers keep their own keys", () => {
  const theirs = ["Tab", "Shift+Tab", "F5", "F11", "F12", "Insert", "CapsLock", "Ctrl+c", "Ctrl+v", "Ctrl+f", "Ctrl+t", "Ctrl+w"];
  const keys = Object.values(SHORTCUTS).flatMap(({ keys }) => keys as readonly string[]);
  assert.deepEqual(keys.filter((key) => theirs.includes(key)), []);
});

test("a key is named with what is held", () => {
  assert.equal(press("W"), "w");
  assert.equal(press("w", { ctrlKey: true }), "Ctrl+w");
  assert.equal(press("F6", { shiftKey: true }), "Shift+F6");
  assert.equal(press("?", { shiftKey: true }), "?"); // a sign, however it is typed
  assert.equal(press("W", { shiftKey: true }), "Shift+w");
  assert.equal(press("s", { metaKey: true }), "Meta+s");
});
