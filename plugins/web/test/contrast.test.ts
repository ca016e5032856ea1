import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { sources } from "./sources";

const css = sources("tokens.css")[0].text;
const block = (selector: string): string => css.slice(css.indexOf(`${selector} {`)).split("}")[0];
const tokens = (text: string): [string, string[]][] =>
  [...text.matchAll(/--([\w-]+): light-dark\((#[0-9a-f]+), (#[0-9a-f]+)\)/g)].map(([, name, ...both]) => [name, both]);
const usual = new Map(tokens(block(":root")));
const more = new Map([...usual, ...tokens(block(':root[data-contrast="more"]'))]);
const THEMES = {
  light: [usual, 0],
  dark: [usual, 1],
  "high contrast, light": [more, 0],
  "high contrast, dark": [more, 1],
} as const;

function luminance(colour: string): number {
  const [r, g, b] = [1, 3, 5].map((at) => {
    const part = parseInt(colour.slice(at, at + 2), 16) / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(a: string, b: string): number {
  const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
}

const GROUNDS = ["ground", "panel", "raised"];
const TEXT = ["ink", "dim", "accent", "bad", "warn", "good", "force", "proxy", "hand"];
const pairs = (tops: string[], grounds: string[]): [string, string][] => tops.flatMap((top) => grounds.map((ground) => [top, ground] as [string, string]));
const READ: [string, string][] = [...pairs(TEXT, GROUNDS), ["accent-ink", "accent"], ["danger-ink", "danger"], ["ink", "tint"], ["dim", "tint"]];
const SEEN: [string, string][] = [...pairs(["edge", "focus", "danger", "accent"], GROUNDS), ["focus", "tint"], ["edge", "tint"]];

test("black on white is 21, and the same on the same 1", () => {
  assert.equal(Math.round(contrast("#000000", "#ffffff")), 21);
  assert.equal(contrast("#123456", "#123456"), 1);
});

for (const [name, [table, at]] of Object.entries(THEMES)) {
  describe(name, () => {
    const least = (pairs: [string, string][], ratio: number): void => {
      const low = pairs.map(([a, b]) => [`--${a} on --${b}`, contrast(table.get(a)![at], table.get(b)![at])] as const);
      assert.deepEqual(low.filter(([, found]) => found < ratio).map(([pair, found]) => `${pair}: ${found.toFixed(2)}`), []);
    };
    test("text can be read", () => least(READ, name.startsWith("high") ? 7 : 4.5));
    test("controls and focus can be seen", () => least(SEEN, 3));
  });
}

/** Marks on the surface stand on their own dark ground in every theme, as they must be seen on any picture. */
const ON_PICTURES = ["web/kit/overlay/overlay.css"];

test("every colour is a token: none is written out elsewhere", () => {
  const found = sources(".css").flatMap(({ name, text }) => {
    if (ON_PICTURES.includes(name) || name === "web/kit/style/tokens.css") return [];
    const rest = text.replace(/var\(--[\w-]+, #[0-9a-f]+\)/g, "");
    return [...rest.matchAll(/(?<![\w-])#[0-9a-f]{3,8}\b(?!\w* *[{,:.>])|\brgba?\(/gi)].map((each) => `${name}: ${each[0]}`);
  });
  assert.deepEqual(found, []);
});
