import assert from "node:assert/strict";
import { test } from "node:test";
import { measure, type Surface } from "kit/overlay/tools/measurement";
import { marks } from "kit/overlay/tools/profile";
import type { Vec } from "kit/server/protocol";

const on = (surface: Surface, x: number, y: number): Vec => [x, y, surface.height(x, y)];
const close = (found: number, wanted: number, share = 1e-9) =>
  assert.ok(Math.abs(found - wanted) <= share * Math.max(Math.abs(wanted), 1e-6), `${found} is not ${wanted}`);
const CELL = 1e-4;

test("on an inclined plane every length is known", () => {
  const plane: Surface = { height: (x, y) => 0.75 * x + 0 * y };
  const found = measure(plane, on(plane, -0.02, 0.01), on(plane, 0.02, 0.01), CELL);
  close(found.horizontalM, 0.04);
  close(found.riseM, 0.03);
  close(found.straightM, 0.05);
  close(found.surfaceM, 0.05);
  close(found.slope, Math.atan(0.75));
  close(measure(plane, on(plane, 0.02, 0.01), on(plane, -0.02, 0.01), CELL).slope, -Math.atan(0.75));
});

test("over a half cylinder the way is half a circle, though its ends are level", () => {
  const radius = 0.01;
  const bridge: Surface = { height: (x) => Math.sqrt(Math.max(0, radius * radius - x * x)) };
  const found = measure(bridge, on(bridge, -radius, 0), on(bridge, radius, 0), 1e-5);
  close(found.surfaceM, Math.PI * radius, 2e-4);
  close(found.straightM, 2 * radius);
  assert.equal(found.slope, 0);
});

test("a step is climbed, and the profile has it where it is", () => {
  const step: Surface = { height: (x) => (x < 0.004 ? 0 : 0.003) };
  const found = measure(step, on(step, 0, 0), on(step, 0.01, 0), CELL);
  close(found.surfaceM, 0.01 + 0.003, 1e-3);
  const at = found.heightsM.findIndex((each) => each > 0);
  close((at / (found.heightsM.length - 1)) * 0.01, 0.004, 0.02);
});

test("nothing is measured between a place and itself, and much is bounded", () => {
  const level: Surface = { height: () => 0.001 };
  const none = measure(level, [0, 0, 0.001], [0, 0, 0.001], CELL);
  assert.deepEqual([none.straightM, none.surfaceM, none.slope], [0, 0, 0]);
  assert.ok(measure(level, [0, 0, 0], [9, 0, 0], 1e-9).heightsM.length < 10_000);
  assert.ok(Number.isNaN(measure({ height: () => NaN }, [0, 0, 0], [1, 0, 0], 1).surfaceM));
});

test("an axis has a few round marks", () => {
  assert.deepEqual(marks(0, 40), [0, 10, 20, 30, 40]);
  assert.deepEqual(marks(-0.12, 0.31), [-0.1, 0, 0.1, 0.2, 0.3]);
  assert.ok(marks(5, 5.0000001).length <= 12);
});
