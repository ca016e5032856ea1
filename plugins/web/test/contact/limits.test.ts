import assert from "node:assert/strict";
import { test } from "node:test";
import { LIMITS, isLimited, perSecond } from "kit/contact/limits";
import { roundDown125 } from "kit/overlay/settings";
import { formatFixed } from "kit/contact/values";
import { FLAGS } from "kit/server/protocol";

test("each flag that changes a force is a limit; touching, a swap and a beacon are none", () => {
  const bits = LIMITS.map(({ bit }) => bit as number);
  const { TOUCHING, SWAPPED, BEACON, ...limits } = FLAGS;
  assert.deepEqual([...bits].sort((a, b) => a - b), Object.values(limits).sort((a, b) => a - b));
  assert.ok(!isLimited(TOUCHING | SWAPPED | BEACON));
  assert.ok(bits.every((bit) => isLimited(bit | TOUCHING)));
});

test("counts are of the second between them, and none where the loop began anew", () => {
  const before = { ticks: 1000, overruns: 2, flagged: { DAMPED: 10 } };
  const rates = perSecond(before, { ticks: 3000, overruns: 6, flagged: { DAMPED: 110, STALE: 4 } }, 2);
  const named = Object.fromEntries(LIMITS.map(({ name }, i) => [name, rates![i]]));
  assert.deepEqual({ ...named }, { FORCE_LIMITED: 0, SLEW_LIMITED: 0, STIFFNESS_LIMITED: 0, DAMPED: 50, RAMPING: 0, STALE: 2, NOT_FINITE: 0, OVERRUN: 2 });
  assert.equal(perSecond(before, { ticks: 10, overruns: 0, flagged: {} }, 1), null);
  assert.equal(perSecond(before, before, 1), null);
  assert.equal(perSecond(before, { ...before, ticks: 2000 }, 0), null);
});

test("a scale is round, and numbers keep their width", () => {
  assert.deepEqual([0.0067, 0.005, 0.0049999, 3, 12, 0].map(roundDown125), [0.005, 0.005, 0.002, 2, 10, 0]);
  assert.deepEqual([formatFixed(-0.0001, 2), formatFixed(-1.5, 2), formatFixed(NaN, 2)], ["0.00", "−1.50", "–"]);
});
