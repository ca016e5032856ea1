import assert from "node:assert/strict";
import { test } from "node:test";
import { Vector3 } from "three";
import { Eye } from "kit/view/camera";
import { handleKey } from "kit/view/camera_input";
import { settle, shareOf } from "kit/view/free_part";

const still = { matches: true } as MediaQueryList;
globalThis.matchMedia ??= () => still;

const pressed = (name: string, more: Partial<KeyboardEvent> = {}) => ({ key: name, ...more }) as KeyboardEvent;

function seen(eye: Eye, x: number, y: number): Vector3 {
  return new Vector3(x, y, 0).project(eye.camera);
}

for (const [w, l] of [[0.08, 0.06], [0.06, 0.3], [10, 0.001], [1e-6, 1e-6]])
  for (const aspect of [1.6, 0.5])
    test(`the whole of ${w} x ${l} m is seen at first, far side up, at an aspect of ${aspect}`, () => {
      const eye = new Eye();
      eye.resize(640, 640 / aspect);
      eye.frame(w, l);
      const corners = [-1, 1].flatMap((x) => [-1, 1].map((y) => seen(eye, (x * w) / 2, (y * l) / 2)));
      assert.ok(corners.every(({ x, y, z }) => Math.abs(x) < 1 && Math.abs(y) < 1 && Math.abs(z) < 1));
      assert.ok(corners.some(({ x, y }) => Math.max(Math.abs(x), Math.abs(y)) > 0.9));
      assert.ok(seen(eye, 0, l / 2).y > seen(eye, 0, -l / 2).y && seen(eye, w / 2, 0).x > seen(eye, -w / 2, 0).x);
    });

/** The hand's, with Shift finely and with Ctrl coarsely. */
const HANDS = [{}, { shiftKey: true }, { ctrlKey: true }].flatMap((held) => ["ArrowLeft", "ArrowUp"].map((each) => pressed(each, held)));

test("what covers the canvas does not cover the surface, which stays whole in the rest", () => {
  const eye = new Eye();
  eye.resize(1600, 1000);
  eye.frame(0.08, 0.06, [0, 0.004]);
  const covered = { top: 0.1, right: 0.3, bottom: 0.2 };
  for (const each of [covered, { ...covered, right: 0 }, covered]) eye.cover(each);
  const corners = [-0.04, 0.04].flatMap((x) => [-0.03, 0.03].flatMap((y) => [0, 0.004].map((z) => new Vector3(x, y, z).project(eye.camera))));
  const [xs, ys] = [corners.map(({ x }) => (x + 1) / 2), corners.map(({ y }) => (1 - y) / 2)];
  assert.ok(Math.min(...xs) > 0 && Math.max(...xs) < 0.7, String(xs));
  assert.ok(Math.min(...ys) > 0.1 && Math.max(...ys) < 0.8, String(ys));
  assert.ok(Math.max(...xs) - Math.min(...xs) > 0.55, "it fills what is free");
  const at = (x: number, z: number): Vector3 => new Vector3(x, 0, z).project(eye.camera);
  const side = 0.001 * Math.sin(eye.pose.polar);
  assert.ok(Math.abs((1.6 * (at(0.001, 0).x - at(0, 0).x)) / (at(0, 0.001).y - at(0, 0).y) / (0.001 / side) - 1) < 0.02, "a square stays one");
  eye.cover({ top: 0, right: 0, bottom: 0 });
  const before = eye.pose.distance;
  eye.home();
  eye.advance(performance.now() + 1000);
  assert.ok(Math.abs(eye.pose.distance / before - 1) < 1e-6, "it is whole again at the old distance");
});

test("a box covers the share of the canvas up to its far side, and none while it is not shown", () => {
  const box = (left: number, top: number, width: number, height: number) => ({ left, top, width, height, right: left + width, bottom: top + height, x: left, y: top });
  const canvas = box(100, 50, 400, 200);
  assert.equal(shareOf(box(110, 60, 80, 36), canvas, "top"), 0.25);
  assert.equal(shareOf(box(110, 204, 80, 36), canvas, "bottom"), 0.25);
  assert.equal(shareOf(box(404, 60, 90, 36), canvas, "right"), 0.25);
  assert.equal(shareOf(box(0, 0, 0, 0), canvas, "right"), 0);
});

test("keys turn, move, zoom, and come home; nobody flies where motion is not wanted", () => {
  const eye = new Eye();
  eye.frame(0.08, 0.06);
  const home = { ...eye.pose };
  assert.ok(handleKey(eye, pressed("ArrowLeft", { shiftKey: true, ctrlKey: true })) && eye.pose.azimuth < 0);
  assert.ok(handleKey(eye, pressed("ArrowUp", { shiftKey: true, ctrlKey: true })) && eye.pose.polar < home.polar);
  assert.ok(handleKey(eye, pressed("ArrowRight", { altKey: true })) && eye.pose.target[0] > 0);
  assert.ok(handleKey(eye, pressed("+")) && eye.pose.distance < home.distance);
  assert.ok(handleKey(eye, pressed("Home", { ctrlKey: true })));
  assert.deepEqual(eye.pose, home);
  assert.ok(handleKey(eye, pressed("End", { ctrlKey: true })) && eye.pose.polar < 0.01);
  for (const other of [pressed("ArrowLeft"), pressed("x"), pressed("+", { ctrlKey: true }), ...HANDS])
    assert.ok(!handleKey(eye, other));
});

test("a zoom leaves the place under the pointer where it is", () => {
  const eye = new Eye();
  eye.frame(0.08, 0.06);
  const before = seen(eye, 0.02, 0.01);
  eye.zoom(0.6, [0.02, 0.01, 0]);
  const after = seen(eye, 0.02, 0.01);
  assert.ok(Math.hypot(before.x - after.x, before.y - after.y) < 1e-6);
});

test("however near, one looks at the ground and not from under it", () => {
  const eye = new Eye();
  eye.frame(0.08, 0.06);
  eye.ground = () => 0.02;
  for (let k = 0; k < 60; k++) eye.zoom(0.85);
  eye.orbit(0, 3);
  assert.ok(Math.abs(eye.pose.target[2] - 0.02) <= 0.3 * eye.pose.distance + 1e-12);
  assert.ok(eye.pose.distance > 1e-3);
});

test("free part follows what covers the canvas in whole steps, and not each pixel of a number that changes", () => {
  const none = { top: 0, right: 0, bottom: 0 };
  const first = settle(none, { ...none, right: 0.2 });
  assert.deepEqual(first, { ...none, right: 0.21875 });
  for (const right of [0.2, 0.21875, 0.21, 0.16]) assert.equal(settle(first, { ...none, right }), first);
  assert.equal(settle(first, { ...none, right: 0.22 }).right, 0.25, "nothing is covered");
  assert.equal(settle(first, { ...none, right: 0.15 }).right, 0.15625, "and nothing much is given away");
  assert.deepEqual(settle(first, none), none, "all of it is free once nothing covers it");
  assert.equal(settle(first, { top: 0.1, right: 0.2, bottom: 0 }).right, 0.21875, "each edge for itself");
});
