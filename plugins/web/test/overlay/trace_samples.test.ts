import assert from "node:assert/strict";
import { test } from "node:test";
import { STRIDE, TraceSamples } from "kit/overlay/pieces/trace_samples";

/** Lines that would be drawn, as pairs of the x of their ends. */
function lines(trail: TraceSamples, sinceS = -1): string[] {
  const x = (slot: number) => trail.data[slot * STRIDE];
  const all = Array.from({ length: trail.slots }, (_, slot) => slot);
  return all.filter((slot) => trail.joins(slot, sinceS)).map((slot) => `${x(slot)}-${x(slot + 1)}`);
}

test("samples are joined one to the next, round the end of the ring", () => {
  const trail = new TraceSamples(4);
  for (let i = 1; i <= 3; i++) trail.add(i, 0, 0, 1, i);
  assert.deepEqual(lines(trail), ["1-2", "2-3"]);
  for (let i = 4; i <= 6; i++) trail.add(i, 0, 0, 1, i);
  assert.deepEqual(lines(trail).sort(), ["3-4", "4-5", "5-6"]);
  assert.equal(trail.data[trail.newest * STRIDE], 6);
});

test("no line crosses a gap, and none is older than asked", () => {
  const trail = new TraceSamples(8);
  trail.add(1, 0, 0, 1, 1);
  trail.add(2, 0, 0, 1, 2);
  trail.lift();
  trail.lift();
  trail.add(3, 0, 0, 1, 3);
  trail.add(4, 0, 0, 1, 4);
  assert.deepEqual(lines(trail), ["1-2", "3-4"]);
  assert.deepEqual(lines(trail, 2.5), ["3-4"]);
  trail.clear();
  assert.deepEqual(lines(trail), []);
  trail.add(5, 0, 0, 1, 5);
  assert.deepEqual(lines(trail), []);
});

test("only what is young enough is looked at", () => {
  const trail = new TraceSamples(4);
  assert.equal(trail.since(0), 0);
  for (let i = 1; i <= 6; i++) trail.add(i, 0, 0, 1, i);
  assert.deepEqual([7, 6, 4.5, 0].map((seconds) => trail.since(seconds)), [0, 1, 2, 4]);
});

test("a long way allocates nothing, and keeps the newest", () => {
  const trail = new TraceSamples(64);
  const { data } = trail;
  const before = process.memoryUsage().heapUsed;
  for (let i = 1; i <= 100_000; i++) trail.add(i % 1000, 0, 0, 1, i);
  assert.ok(process.memoryUsage().heapUsed - before < 2e6);
  assert.equal(trail.data, data);
  assert.equal(lines(trail).length, 63);
});
