import assert from "node:assert/strict";
import { test } from "node:test";
import { GripRule, type ContactSample } from "kit/contact/grip";
import type { Vec } from "kit/server/protocol";

const MU = 0.4;
const PERIOD_MS = 1000 / 60;

/** A contact for so many states: where it is and what the force is, by the time in seconds. */
function follow(rule: GripRule, states: number, at: (s: number) => Partial<ContactSample>): string[] {
  return Array.from({ length: states }, (_, i) => {
    const level: ContactSample = { touching: true, atMs: i * PERIOD_MS, contact: [0, 0, 0], normal: [0, 0, 1], force: [0, 0, 2], dynamicFriction: MU };
    return rule.update({ ...level, ...at((i * PERIOD_MS) / 1000) });
  });
}

test("a proxy that stays while the hand pulls at it sticks; one that nothing pulls at rests", () => {
  assert.deepEqual(new Set(follow(new GripRule(), 30, (s) => ({ force: [-0.5 * s, 0, 2] })).slice(20)), new Set(["sticks"]));
  assert.deepEqual(new Set(follow(new GripRule(), 30, () => ({}))), new Set(["rests"]));
});

test("one that moves against friction slips, with the force at the cone's edge", () => {
  const found = follow(new GripRule(), 60, (s) => ({ contact: [0.02 * s, 0, 0], force: [-2 * MU, 0, 2] }));
  assert.equal(found[0], "sticks");
  assert.deepEqual(new Set(found.slice(10)), new Set(["slips"]));
});

test("one that moves without friction, or is pushed along, glides", () => {
  const moving = (force: Vec) => follow(new GripRule(), 40, (s) => ({ contact: [0.02 * s, 0, 0], force })).at(-1);
  assert.equal(moving([0, 0, 2]), "glides");
  assert.equal(moving([2 * MU, 0, 2]), "glides");
  const ice = follow(new GripRule(), 40, (s) => ({ contact: [0.02 * s, 0, 0], force: [-0.5, 0, 2], dynamicFriction: 0 }));
  assert.equal(ice.at(-1), "glides");
});

test("stick and slip take turns as the contact stops and goes", () => {
  const stops = (s: number) => (s < 0.5 ? 0.03 * s : 0.015);
  const found = follow(new GripRule(), 70, (s) => ({ contact: [stops(s), 0, 0], force: [-2 * MU, 0, 2] }));
  assert.equal(found[25], "slips");
  assert.equal(found[69], "sticks");
});

test("on a slope only what goes along it counts", () => {
  const normal: Vec = [-Math.SQRT1_2, 0, Math.SQRT1_2];
  const along = (share: number): Vec => [2 * normal[0] - share * Math.SQRT1_2, 0, 2 * normal[2] - share * Math.SQRT1_2];
  const up = (s: number): Vec => [0.02 * s, 0, 0.02 * s];
  assert.equal(follow(new GripRule(), 40, (s) => ({ normal, contact: up(s), force: along(2 * MU) })).at(-1), "slips");
  assert.equal(follow(new GripRule(), 40, (s) => ({ normal, contact: up(s), force: along(0) })).at(-1), "glides");
  const sunk = (s: number): Vec => [0.02 * s, 0, -0.02 * s]; // along the normal: no motion on the surface
  assert.equal(follow(new GripRule(), 40, (s) => ({ normal, contact: sunk(s), force: along(0) })).at(-1), "rests");
});

test("a contact that trembles by less than it can be seen to move neither slips nor flickers", () => {
  const found = follow(new GripRule(), 120, (s) => ({ contact: [1e-5 * Math.sin(60 * s), 0, 0], force: [-0.5, 0, 2] }));
  assert.deepEqual(new Set(found), new Set(["sticks"]));
});

test("nothing of the last contact is left in the next, nor of a pause", () => {
  const rule = new GripRule();
  follow(rule, 30, (s) => ({ contact: [0.02 * s, 0, 0], force: [-2 * MU, 0, 2] }));
  const level: ContactSample = { touching: true, atMs: 1e4, contact: [0.5, 0, 0], normal: [0, 0, 1], force: [-0.5, 0, 2], dynamicFriction: MU };
  assert.equal(rule.update({ ...level, touching: false }), "apart");
  assert.equal(rule.update({ ...level, contact: [0.1, 0, 0] }), "sticks");
  assert.equal(rule.update({ ...level, contact: [0.1, 0, 0], atMs: 1e4 + PERIOD_MS }), "sticks");
  assert.equal(rule.update({ ...level, atMs: 2e4 }), "sticks");
  assert.equal(rule.update({ ...level, force: [NaN, 0, NaN] }), "apart");
});
