import assert from "node:assert/strict";
import { test } from "node:test";
import { COLUMNS, Ticks } from "../src/panels/recordings/ticks";

/** 100 ticks of a millisecond, the force rising to 1 N. */
function rising(count = 100): Ticks {
  const rows = new Float32Array(count * COLUMNS);
  for (let i = 0; i < count; i++) {
    rows[i * COLUMNS] = i / 1000;
    rows[i * COLUMNS + 2] = i / 10000;
    rows[i * COLUMNS + 13] = i / (count - 1);
    rows[i * COLUMNS + 14] = 1;
  }
  return new Ticks(rows);
}

test("a time finds the tick that had begun by then", () => {
  const ticks = rising();
  for (const i of [0, 1, 50, 98, 99]) assert.equal(ticks.at(ticks.time(i)), i);
  assert.equal(ticks.at(0.0504), 50);
  assert.equal(ticks.at(-1), 0);
  assert.equal(ticks.at(99), 99);
});

test("a tick is the state that was felt", () => {
  const state = rising().state(50);
  assert.ok(Math.abs(state.hand[0] - 0.005) < 1e-9);
  assert.ok(Math.abs(state.force[2] - 50 / 99) < 1e-6);
  assert.equal(state.flags, 1);
});

test("the outline keeps every span's strongest force", () => {
  const found = rising().outline(10);
  assert.equal(found.length, 10);
  for (let k = 1; k < 10; k++) assert.ok(found[k]! > found[k - 1]!);
  assert.ok(Math.abs(found[9]! - 1) < 1e-6);
});

test("nothing recorded is nothing shown", () => {
  const empty = new Ticks(new Float32Array(0));
  assert.equal(empty.count, 0);
  assert.equal(empty.seconds, 0);
  assert.deepEqual([...empty.outline(3)], [0, 0, 0]);
});
