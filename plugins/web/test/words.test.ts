import assert from "node:assert/strict";
import { before, test } from "node:test";
import { LANGUAGES, tables, words, type Table } from "kit/words/words";
import { sources } from "./sources";

const ENGLISH = /\b(the|and|of|is|are|with|this|that|not|you|your|what|which|there|for)\b/i;
/** Not English, though they look like it. */
const GERMAN = /\b(was|in|so|die|an|am|hat|man|war|hell|rate|kind|fast|bald|arm|tag|log|wand)\b/gi;
const slots = (text: string): string[] => [...text.matchAll(/\{(\w+)\}/g)].map((found) => found[1]).sort();
const texts = (): [string, Table[string]][] => tables.flatMap((table) => Object.entries(table));

before(async () => {
  for (const { name } of sources("words.ts")) await import(`../../${name.slice(0, -"words.ts".length)}words.ts`);
});

test("every file of words is seen here", () => {
  const files = sources(".ts").filter(({ text }) => /\bwords\(\{/.test(text));
  assert.equal(new Set(tables).size, files.length);
});

test("every text is in all languages, with the same slots", () => {
  for (const [key, row] of texts()) {
    assert.equal(row.length, LANGUAGES.length, key);
    for (const other of row.slice(1) as string[]) {
      assert.equal(other.trim() === "", row[0].trim() === "", key);
      assert.deepEqual(slots(other), slots(row[0]), key);
    }
  }
});

test("nothing in the German column is English", () => {
  for (const [key, [, german]] of texts()) assert.doesNotMatch(german.replace(/\{\w+\}/g, "").replace(GERMAN, ""), ENGLISH, `${key}: ${german}`);
});

test("nothing in the French column is English", () => {
  for (const [key, row] of texts()) assert.doesNotMatch(row[2]!.replace(/\{\w+\}|Learned depth/g, ""), /\b(the|and|of|is|with|your|what)\b/i, key);
});

test("people are told Sie, never Du, and quotation marks are theirs", () => {
  for (const [key, [, german]] of texts()) {
    assert.doesNotMatch(german, /\b(du|dich|dir|dein\w*)\b/i, key);
    assert.doesNotMatch(german, /"/, key);
  }
});

test("German has the terms of the glossary", () => {
  const wrong = /Vorhang|Vorhänge|Elevation|Haptikgerät|Kraftgerät|Stiftdisplay|Pin-Display|Keine Irrtümer|„Export“/;
  for (const [key, [, german]] of texts()) assert.doesNotMatch(german, wrong, key);
  const said = (english: string): string => texts().find(([, row]) => row[0] === english)![1][1];
  assert.deepEqual(["No errors.", "elevation", "Steep walls at depth edges", "Export", "a force device", "Pin display"].map(said), [
    "Keine Fehler.", "Höhenwinkel", "Steilwände an Tiefenkanten", "Exportieren", "einem haptischen Gerät", "Taktiles Display",
  ]);
});

test("a text ends as its twin does", () => {
  const end = (text: string): string => /[.:!?…]$/.exec(text.trim())?.[0] ?? "";
  for (const [key, [english, german]] of texts()) assert.equal(end(english), end(german), key);
});

test("slots are filled, and one without a value stays to be seen", () => {
  const t = words({ opened: ["{name} is open, {count}", "{name} ist offen, {count}"] } satisfies Table);
  assert.equal(t("opened", { name: "a", count: 0 }), "a is open, 0");
  assert.equal(t("opened", { name: "{count}" }), "{count} is open, {count}");
  assert.ok(t.has("opened") && !t.has("toString"));
});

/** What puts text before people, given a literal: a string, or a template. */
const SINKS = [
  String.raw`\.(?:textContent|innerText|title|placeholder|alt|ariaLabel|label|caption) = `,
  String.raw`"aria-(?:label|description|roledescription|valuetext)", `,
  String.raw`\b(?:say|button|append|prepend|replaceChildren|Option|alert|confirm)\(`,
];
const SHOWN = new RegExp(`(?:${SINKS.join("|")})(?:"([^"]*)"|\`([^\`]*)\`)`, "g");

/** Whether something of a literal is words: not what is put in, and not a unit. */
const isText = (literal: string): boolean => /[A-Za-z]{2}/.test(literal.replace(/\$\{[^}]*\}|\b(?:mm|ms|Hz)\b/g, ""));

test("no text for people stands outside the tables", () => {
  const found = sources(".ts").flatMap(({ name, text }) =>
    name.endsWith("words.ts") ? [] : [...text.matchAll(SHOWN)].filter((each) => isText(each[1] ?? each[2])).map((each) => `${name}: ${each[0]}`),
  );
  assert.deepEqual(found, []);
});

test("such a text would be found", () => {
  for (const line of ['a.textContent = "Open it";', "b.append(`${n} lines`)", 'c.setAttribute("aria-label", "Lines")']) {
    assert.ok([...line.matchAll(SHOWN)].some((each) => isText(each[1] ?? each[2])), line);
  }
  for (const line of ['a.textContent = t("open");', "b.append(`${n} `)", 'c.append(" ", box)']) {
    assert.ok(![...line.matchAll(SHOWN)].some((each) => isText(each[1] ?? each[2])), line);
  }
});
