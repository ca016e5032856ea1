import assert from "node:assert/strict";
import { test } from "node:test";
import { firstRoot, Grid } from "kit/surface/grid";
import type { Material, Meta } from "kit/server/messages";
import { describePlace } from "kit/speech/names";
import { place } from "kit/contact/reading";
import { asJson, shortRows, rows } from "kit/contact/values";
import type { Vec } from "kit/server/protocol";
import { Scene, type Part } from "kit/surface/scene";

const W = 0.08;

function random(seed: number): () => number {
  let state = seed;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
}

/** A surface whose cells have these heights. */
function scene(rows: number, columns: number, height: (x: number, y: number) => number, l = (W * rows) / columns): Scene {
  const [dx, dy] = [W / columns, l / rows];
  const heights = Float32Array.from({ length: rows * columns }, (_, k) =>
    height(((k % columns) + 0.5) * dx - W / 2, l / 2 - (Math.floor(k / columns) + 0.5) * dy),
  );
  const grid = new Grid(heights, rows, columns, { left: -W / 2, far: l / 2, dx, dy });
  const labels = Uint16Array.from(heights, (_, k) => k % 3);
  const meta = {
    rows, columns, extent_m: [W, l], height_m: [heights.reduce((a, b) => Math.min(a, b)), heights.reduce((a, b) => Math.max(a, b))],
    materials: [{ name: "wood" }, { name: "ice" }] as Material[], labels: 3, levels: [{ step: 1, rows, columns }],
  } as unknown as Meta;
  return new Scene(meta, { grid, labels }, Uint16Array.of(0, 1, 1), null);
}

/** Bilinear between centres, constant to the rim: by hand. */
function byHand({ meta, whole }: Scene, x: number, y: number): number {
  const { rows, columns, extent_m: [w, l] } = meta;
  const [u, v] = [(x / w + 0.5) * columns - 0.5, (0.5 - y / l) * rows - 0.5];
  let sum = 0;
  for (let j = -1; j <= rows; j++)
    for (let i = -1; i <= columns; i++) {
      const weight = Math.max(0, 1 - Math.abs(u - i)) * Math.max(0, 1 - Math.abs(v - j));
      const [c, r] = [Math.min(Math.max(i, 0), columns - 1), Math.min(Math.max(j, 0), rows - 1)];
      sum += weight * whole.grid.heights[r * columns + c];
    }
  return sum;
}

const rough = (seed: number) => {
  const next = random(seed);
  return () => 0.01 * next();
};

for (const [rows, columns] of [[7, 9], [1, 1], [1, 12], [12, 1], [2, 2]])
  test(`height is bilinear and constant to the rim, ${rows} x ${columns}`, () => {
    const made = scene(rows, columns, rough(rows + columns), 0.06);
    const next = random(5);
    for (let k = 0; k < 300; k++) {
      const [x, y] = [W * (next() - 0.5), 0.06 * (next() - 0.5)];
      assert.ok(Math.abs(made.height(x, y) - byHand(made, x, y)) < 1e-12);
    }
    assert.ok(Number.isNaN(made.height(0.041, 0)) && Number.isNaN(made.height(0, -0.031)));
    assert.deepEqual(made.on(1, 1), [0.04, 0.03, made.height(0.04, 0.03)]);
  });

test("the normal of a slope is the slope's, at the rim too", () => {
  const made = scene(30, 40, (x, y) => 0.05 + 0.3 * x - 0.2 * y);
  const n = Math.hypot(0.3, 0.2, 1);
  for (const [x, y] of [[0, 0], [0.0123, -0.02]]) {
    const [a, b, c] = made.normal(x, y);
    for (const [is, wanted] of [[a, -0.3 / n], [b, 0.2 / n], [c, 1 / n]]) assert.ok(Math.abs(is - wanted) < 1e-5);
  }
  for (const place of [[0.04, 0.03], [-0.04, 0], [1, 1]]) assert.ok(made.normal(place[0], place[1]).every(Number.isFinite));
  assert.deepEqual(scene(1, 1, () => 0.01).normal(0, 0).map(Math.abs), [0, 0, 1]);
});

test("label and material are those of the cell that a place is in", () => {
  const made = scene(2, 3, () => 0);
  assert.equal(made.label(-0.03, 0.02), 0);
  assert.equal(made.label(0, -0.02), 1);
  assert.equal(made.material(-0.03, 0.02)?.name, "wood");
  assert.equal(made.material(0.04, 0.02)?.name, "ice");
  assert.equal(made.material(0.05, 0), null);
  assert.equal(made.label(0, 0.05), null);
});

test("a ray meets a plane where it should", () => {
  const made = scene(30, 40, (x, y) => 0.02 + 0.1 * x + 0.2 * y);
  const next = random(11);
  for (let k = 0; k < 200; k++) {
    const [x, y] = [0.9 * W * (next() - 0.5) * 0.9, 0.05 * (next() - 0.5)];
    const from: Vec = [x + 0.1 * (next() - 0.5), y - 0.05, 0.1];
    const at: Vec = [x, y, 0.02 + 0.1 * x + 0.2 * y];
    const hit = made.pick(from, at.map((part, i) => part - from[i]) as Vec);
    for (let i = 0; i < 3; i++) assert.ok(Math.abs(hit![i] - at[i]) < 1e-7, `${hit} ${at}`);
  }
});

test("a ray meets a sphere where it should", () => {
  const radius = 0.05;
  const made = scene(480, 640, (x, y) => Math.sqrt(Math.max(radius * radius - x * x - y * y, 0)));
  for (const [x, y] of [[0, 0], [0.01, 0.013], [-0.02, 0.005]]) {
    const z = Math.sqrt(radius * radius - x * x - y * y);
    const hit = made.pick([3 * x, 3 * y, 3 * z], [-x, -y, -z]);
    assert.ok(Math.hypot(hit![0] - x, hit![1] - y, hit![2] - z) < 1e-6);
  }
});

test("a thousand rays meet what a fine walk along them meets", () => {
  const made = scene(24, 32, rough(3));
  compare(made, 1000, 2e-5);
});

test("so they do where a part is finer", () => {
  const made = scene(24, 32, rough(3));
  const next = random(8);
  const place = { left: -0.01, far: 0.02, dx: W / 96, dy: W / 96 };
  const heights = Float32Array.from({ length: 40 * 30 }, () => 0.01 * next());
  made.detail = { grid: new Grid(heights, 30, 40, place), labels: new Uint16Array(1200).fill(2) } as Part;
  assert.equal(made.height(0, 0.01), made.detail.grid.height(0, 0.01));
  assert.equal(made.height(-0.02, 0.01), made.whole.grid.height(-0.02, 0.01));
  assert.equal(made.label(0, 0.01), 2);
  compare(made, 400, 2e-5);
});

function compare(made: Scene, rays: number, near: number): void {
  const next = random(21);
  let [met, missed] = [0, 0];
  for (let k = 0; k < rays; k++) {
    const from: Vec = [0.2 * (next() - 0.5), 0.2 * (next() - 0.5), 0.02 + 0.05 * next()];
    const at: Vec = [0.1 * (next() - 0.5), 0.08 * (next() - 0.5), 0.004 * next()];
    const way = at.map((part, i) => part - from[i]) as Vec;
    const hit = made.pick(from, way);
    const wanted = walked(made, from, way);
    if (wanted === null) assert.ok(hit === null || grazes(made, from, way), `ray ${k} meets ${hit}`);
    else assert.ok(hit && Math.hypot(hit[0] - wanted[0], hit[1] - wanted[1]) < near, `ray ${k}: ${hit}, ${wanted}`);
    if (wanted) met++;
    else missed++;
  }
  assert.ok(met > rays / 10 && missed > rays / 20, `${met} met, ${missed} missed`);
}

const STEPS = 40_000;

function walked(made: Scene, o: Vec, d: Vec): Vec | null {
  for (let k = 0; k <= STEPS; k++) {
    const t = (1.5 * k) / STEPS;
    const [x, y, z] = o.map((part, i) => part + t * d[i]);
    if (z < made.meta.height_m[0]) return null; // under the block
    if (z <= made.height(x, y)) return [x, y, made.height(x, y)];
  }
  return null;
}

/** Whether the walk's steps are too long to tell. */
function grazes(made: Scene, o: Vec, d: Vec): boolean {
  let least = Infinity;
  for (let k = 0; k <= STEPS; k++) {
    const t = (1.5 * k) / STEPS;
    const above = o[2] + t * d[2] - made.height(o[0] + t * d[0], o[1] + t * d[1]);
    if (above < least) least = above;
  }
  return least < 1e-5;
}

test("a spike of one cell is not leapt over", () => {
  const made = scene(480, 640, (x, y) => (Math.hypot(x - 0.01, y) < 0.0001 ? 0.01 : 0));
  const hit = made.pick([0.2, 0.00001, 0.008], [-1, 0, -0.001]);
  assert.ok(hit && Math.abs(hit[0] - 0.01) < 0.0003);
});

test("a ray onto the side of the block is felt at its rim, one past it or away from it nowhere", () => {
  const made = scene(3, 4, (x) => (x > 0.02 ? 0.01 : 0));
  assert.deepEqual(made.pick([1, 0, 0.005], [-1, 0, 0]), [0.04, 0, made.height(0.04, 0)]);
  assert.equal(made.pick([1, 0, 0.02], [-1, 0, 0]), null);
  assert.equal(made.pick([0, 0, 1], [0, 0, 1]), null);
  assert.deepEqual(made.pick([0.01, 0.01, 1], [0, 0, -1])!.slice(0, 2), [0.01, 0.01]);
  assert.equal(made.pick([1, 1, 1], [0, 0, -1]), null);
});

test("the first root of a polynomial", () => {
  assert.ok(Math.abs(firstRoot(1, -3, 2) - 1) < 1e-12);
  assert.equal(firstRoot(0, -2, 1), 0.5);
  assert.equal(firstRoot(1, 0, 1), Infinity);
  assert.equal(firstRoot(0, 0, 1), Infinity);
  assert.equal(firstRoot(1, 3, 2), Infinity);
  assert.ok(Math.abs(firstRoot(-1, 1, 2) - 2) < 1e-12);
});

test("a part is called by its name, with its material; one without a name by material and number", () => {
  const made = scene(3, 3, () => 0);
  const called = (x: number): string => describePlace(made.material(x, 0)?.name, made.part(x, 0), made.label(x, 0), 3);
  assert.deepEqual([-0.03, 0, 0.03].map(called), ["wood, part 1", "ice, part 2", "ice, part 3"]);
  (made.meta as { parts: string[] }).parts = ["door", "", "pane"];
  assert.deepEqual([-0.03, 0, 0.03].map(called), ["door, wood", "ice, part 2", "pane, ice"]);
  assert.equal(made.part(1, 1), "");
  const rowOf = (x: number): string => rows(null, place(made, x, 0)).find(([name]) => name === "Material")![1]!;
  assert.deepEqual([-0.03, 0].map(rowOf), ["door, wood", "ice, part 2"]);
  (made.meta.materials[0] as { name: string }).name = "plain";
  const short = shortRows(null, place(made, -0.03, 0));
  assert.deepEqual(short.map(([name]) => name), ["Force", "Material", "Height"]);
  assert.equal(short[1]![1], "plain material", "in words, as everywhere");
  assert.equal(JSON.parse(asJson(null, place(made, -0.03, 0))).pointer.part_name, "door");
});
