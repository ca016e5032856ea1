import assert from "node:assert/strict";
import { test } from "node:test";
import { pressedButtons, limits } from "../../src/panels/devices/doctor";
import { presenceOf } from "../../src/panels/devices/list";
import { points } from "../../src/panels/devices/sparkline";
import { holderOf } from "../../src/panels/hand/panel";

test("the doctor says which buttons are pressed, which limits acted, and draws what was last on the right", () => {
  assert.deepEqual(pressedButtons(0b101), [1, 3]);
  assert.equal(limits({ TOUCHING: 900, FORCE_LIMITED: 12, DAMPED: 0 }), "force limited 12");
  assert.equal(points([0, 2, 4], 60), "57,1.000 58,0.500 59,0.000");
  assert.equal(points([0], 60), "59,1.000");
});

test("a device is simulated, connected, not connected, or cannot be looked for", () => {
  const none = { name: "", summary: "", simulated: null, units: [], problem: "", usable: false };
  assert.equal(presenceOf({ ...none, simulated: true }), "simulated");
  assert.equal(presenceOf({ ...none, units: [{ name: "", serial: "", place: "", problem: "busy" }] }), "connected");
  assert.equal(presenceOf({ ...none, simulated: false }), "notConnected");
  assert.equal(presenceOf({ ...none, problem: "no driver" }), "notAsked");
});

test("who holds the hand is said in words", () => {
  const hand = { there: true, holding: false, nobodyHolds: false, rests: false };
  assert.equal(holderOf({ ...hand, there: false }), "gone");
  assert.equal(holderOf({ ...hand, holding: true, rests: true }), "rests");
  assert.equal(holderOf({ ...hand, holding: true }), "holds");
  assert.equal(holderOf({ ...hand, nobodyHolds: true }), "nobody");
  assert.equal(holderOf(hand), "watches");
});
