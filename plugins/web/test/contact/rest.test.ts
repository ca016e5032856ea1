import assert from "node:assert/strict";
import { test } from "node:test";
import { Rest } from "kit/contact/rest";
import type { State } from "kit/server/protocol";

const STILL: State = {
  status: 3, flags: 1, seq: 0, tag: 0, overruns: 0, sampleMs: 0, hand: [0.01, 0.02, 0.003], proxy: [0.01, 0.02, NaN],
  force: [0, 0, 1], velocity: [0, 0, 0], other: [0, 0, 0], lateUs: 1, arrivedMs: 0,
};

/** Whether a hand is at rest at the end of so many seconds, of states as they come. */
function rests(seconds: number, at: (s: number) => Partial<State>): boolean {
  const rest = new Rest();
  const found = Array.from({ length: Math.round(60 * seconds) }, (_, i) => {
    const s = i / 60;
    return rest.isAtRest({ ...STILL, seq: i, overruns: i, lateUs: i, sampleMs: 1e3 * s, arrivedMs: 1e3 * s, ...at(s) });
  });
  return found.at(-1)!;
}

test("a hand that stays is at rest after a second, whatever else is counted", () => {
  assert.equal(rests(0.9, () => ({})), false);
  assert.equal(rests(1.2, () => ({})), true);
  assert.equal(rests(1.2, () => ({ proxy: [0.01, 0.02, 0.004] })), true);
});

test("one that creeps is not, however slowly", () => {
  assert.equal(rests(3, (s) => ({ hand: [0.01 + 1.5e-5 * s, 0.02, 0.003] })), false);
  assert.equal(rests(3, (s) => ({ force: [0, 0, 1 + 0.008 * s] })), false);
});

test("whatever changes is drawn at once", () => {
  const later = (change: Partial<State>) => rests(2, (s) => (s > 1.95 ? change : {}));
  assert.equal(later({}), true);
  for (const change of [
    { hand: [0.011, 0.02, 0.003] }, { force: [0, 0.1, 1] }, { other: [0, 0, 1] }, { flags: 3 }, { status: 1 },
    { proxy: [0.01, 0.02, 0.003] },
  ] as Partial<State>[])
    assert.equal(later(change), false, JSON.stringify(change));
});
