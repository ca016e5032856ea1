import assert from "node:assert/strict";
import { test } from "node:test";
import { asText, Lines, MAX_LINES, isShown, type Level } from "../../src/panels/log/lines";

const all = new Set<Level>(["event", "detail", "warning", "error"]);

test("at most so many are kept, the newest", () => {
  const lines = new Lines();
  const dropped = Array.from({ length: MAX_LINES + 3 }, (_, i) => lines.add("event", `line ${i}`, i).dropped?.text);
  assert.equal(lines.all.length, MAX_LINES);
  assert.deepEqual(dropped.slice(-4), [undefined, "line 0", "line 1", "line 2"]);
  assert.equal(lines.all.at(-1)!.text, `line ${MAX_LINES + 2}`);
});

test("the same line again counts up and has the newest time", () => {
  const lines = new Lines();
  lines.add("warning", "dark", 1);
  assert.equal(lines.add("warning", "dark", 2).again, true);
  assert.equal(lines.add("error", "dark", 3).again, false);
  assert.deepEqual(lines.all.map(({ times, at_s }) => [times, at_s]), [[2, 2], [1, 3]]);
});

test("a line is seen if its level is, and all words are in it", () => {
  const line = { level: "warning", text: "The picture is DARK", foreign: "", at_s: 0, times: 1 } as const;
  assert.ok(isShown(line, all, ""));
  assert.ok(isShown(line, all, "dark  picture"));
  assert.ok(!isShown(line, all, "dark bright"));
  assert.ok(!isShown(line, new Set<Level>(["error"]), "dark"));
});

test("as text every line has its time, level and count", () => {
  const lines = new Lines();
  lines.add("event", "made", 0);
  lines.add("error", "failed", 1.5);
  lines.add("error", "failed", 2);
  assert.equal(asText(lines.all), "1970-01-01T00:00:00.000Z event made\n1970-01-01T00:00:02.000Z error failed (x 2)\n");
});
