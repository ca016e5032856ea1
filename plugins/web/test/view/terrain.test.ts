import assert from "node:assert/strict";
import { test } from "node:test";
import type { Meta } from "kit/server/messages";
import { heat, heatTexels, isMarked, PALETTE, PATTERNS, styleOf } from "kit/terrain/colours";
import { checkSettings, DEFAULTS } from "kit/view/settings";
import { pickIndices, strideOf, triangles, MAX_MOVING } from "kit/terrain/triangles";
import { includes, MAX_CELLS, windowOf } from "kit/surface/detail_window";

function large(columns = 4300, rows = 4200): Meta {
  const levels = [1, 2, 4, 8].map((step) => ({ step, rows: Math.ceil(rows / step), columns: Math.ceil(columns / step) }));
  return { rows, columns, extent_m: [0.08, (0.08 * rows) / columns], levels } as unknown as Meta;
}

const around = (x: number, y: number, side: number) => ({ left: x - side / 2, right: x + side / 2, near: y - side / 2, far: y + side / 2 });

test("what is looked at is fetched as finely as can be drawn, and no finer than is seen", () => {
  const meta = large();
  assert.equal(windowOf(meta, around(0, 0, 0.08), 1e-4), null);
  const half = windowOf(meta, around(0, 0, 0.03), 5e-5)!;
  assert.equal(half.level, 2);
  const near = windowOf(meta, around(0.01, -0.02, 0.006), 1e-5)!;
  assert.equal(near.level, 0);
  assert.ok(near.rows * near.columns <= MAX_CELLS);
  const pitch = 0.08 / 4300;
  assert.ok(near.column * pitch - 0.04 <= 0.007 && (near.column + near.columns) * pitch - 0.04 >= 0.013);
  assert.ok(0.08 * (4200 / 4300) / 2 - near.row * pitch >= -0.017);
  assert.ok(includes(half, { ...half, row: half.row + 1, rows: half.rows - 2 }));
  assert.ok(!includes(half, { ...half, row: half.row - 1 }) && !includes(half, near));
});

test("a window stays within the surface, and a surface of one level has none", () => {
  const meta = large();
  const corner = windowOf(meta, around(0.04, 0.039, 0.004), 1e-5)!;
  assert.ok(corner.row === 0 && corner.column + corner.columns === 4300);
  assert.equal(windowOf({ ...meta, levels: meta.levels.slice(0, 1) }, around(0, 0, 0.01), 1e-5), null);
});

test("triangles cover the grid and its ring, whatever the stride", () => {
  for (const [rows, columns] of [[1, 1], [1, 9], [7, 5], [480, 640]])
    for (const stride of [1, 2, 3, 50]) {
      const [across, along] = [pickIndices(columns, stride), pickIndices(rows, stride)];
      assert.deepEqual([across[0], across.at(-1), along.at(-1)], [0, columns + 1, rows + 1]);
      assert.ok(across.every((each, k) => k === 0 || each > across[k - 1]), String(across));
      const index = triangles(rows, columns, stride);
      assert.equal(index.length, 6 * (across.length - 1) * (along.length - 1));
      assert.ok(index.every((each) => each < (rows + 2) * (columns + 2)));
    }
  const stride = strideOf(480, 640);
  assert.ok(triangles(480, 640, stride).length / 3 < 1.2 * MAX_MOVING);
});

test("a greater value is lighter, and the ends are the ends", () => {
  const lightness = Array.from({ length: 256 }, (_, k) => heat(k / 255)).map(([r, g, b]) => 0.21 * r + 0.72 * g + 0.07 * b);
  assert.ok(lightness.every((each, k) => k === 0 || each > lightness[k - 1]));
  assert.deepEqual(heat(-1), heat(0));
  assert.deepEqual([...heatTexels().slice(0, 4)], [0x44, 0x01, 0x54, 255]);
  assert.deepEqual([...heatTexels().slice(-4)], [0xfd, 0xe7, 0x25, 255]);
});

test("64 kinds differ in colour or pattern, and those of one colour in how much is marked or where", () => {
  const styles = Array.from({ length: 64 }, (_, kind) => styleOf(kind));
  assert.equal(new Set(styles.map(({ colour, pattern }) => `${colour} ${pattern}`)).size, 64);
  assert.equal(new Set(Array.from({ length: 8 }, (_, kind) => styleOf(kind).pattern)).size, 8);
  assert.equal(PALETTE.length, 8);
  const drawn = (pattern: number): string => Array.from({ length: 400 }, (_, k) => +isMarked(pattern, (k % 20) / 20 + 0.025, Math.floor(k / 20) / 20 + 0.025)).join("");
  assert.equal(new Set(Array.from({ length: PATTERNS }, (_, pattern) => drawn(pattern))).size, PATTERNS);
});

test("settings that were kept are taken as far as they make sense", () => {
  assert.deepEqual(checkSettings(null), DEFAULTS);
  assert.deepEqual(checkSettings("x"), DEFAULTS);
  const found = checkSettings({ look: "height", steep: "toString", raking: 7, normals: NaN, azimuthDeg: 90, other: 1 });
  assert.deepEqual(found, { ...DEFAULTS, look: "height", azimuthDeg: 90 });
});
