import assert from "node:assert/strict";
import { test } from "node:test";
import { ranked, score } from "../../src/palette/match";

const best = (query: string, ...texts: string[]): string[] => ranked(query, texts, (text) => [text]);

test("letters in their order match, others do not", () => {
  assert.notEqual(score("mkf", "Make and feel"), null);
  assert.equal(score("xyz", "Make and feel"), null);
  assert.equal(score("elf", "feel"), null);
});

test("every word is looked for, in any order, without accents and in any case", () => {
  assert.notEqual(score("FEEL make", "Make and feel"), null);
  assert.equal(score("make undo", "Make and feel"), null);
  assert.notEqual(score("oberflache", "Oberfläche"), null);
  assert.notEqual(score("grosse", "Größe"), null);
});

test("a match at starts of words leaves out one within words, and letters together one of letters apart", () => {
  assert.deepEqual(best("ra", "Drawing", "Raking light"), ["Raking light"]);
  assert.deepEqual(best("save", "Scale of averages", "Save"), ["Save"], "letters that stand anywhere are not what was meant");
});

test("without a query all stay in their order, and an item is found by its later texts after others by their first", () => {
  assert.deepEqual(best(" ", "b", "a"), ["b", "a"]);
  const items = [["Sichern", "Save"], ["Save", ""]];
  assert.deepEqual(ranked("save", items, (texts) => texts), [items[1], items[0]]);
});
