import assert from "node:assert/strict";
import { test } from "node:test";
import { magnificationOf } from "kit/hand/hand";
import { HELD_MS, HeldKeys, PACES } from "kit/hand/keyboard";
import { type Ground, HOVER_M, nextPosition, SPEED, clampToRim } from "kit/hand/motion";
import { meetLevel } from "kit/hand/mouse";
import { Presses, DEAD_ZONE, Rumble, readPad } from "kit/hand/game_pad";
import { findPartCentres } from "kit/hand/part_centres";
import { Fingers, Pressure } from "kit/hand/fingers";
import type { Vec } from "kit/server/protocol";

const PRESS_M = 0.0015;
const STEP_S = 0.016;
const ALONE = { shiftKey: false, ctrlKey: false };

/** 100 x 60 mm; a wall of 10 mm, half a millimetre wide, at x = 10 mm. */
const wall: Ground = {
  meta: { extent_m: [0.1, 0.06], height_m: [0, 0.01], columns: 200 },
  height: (x) => 0.01 * Math.min(1, Math.max(0, (x - 0.01) / 0.0005)),
};

/** Every place on the way to a goal over the ground. */
function path(from: Vec | null, over: [number, number], gapM: number, ground = wall, steps = 60, slower = 1): Vec[] {
  const hit: Vec[] = [];
  for (let i = 0; i < steps; i++) hit.push(nextPosition(hit.at(-1) ?? from, { over, gapM }, STEP_S, ground, slower));
  return hit;
}

test("the first place is over the surface, whatever was picked", () => {
  const at = nextPosition(null, { over: [-0.02, 0], gapM: -PRESS_M }, 0, wall);
  assert.deepEqual(at, [-0.02, 0, HOVER_M]);
  assert.equal(nextPosition(null, { at: [-0.02, 0, -0.5] }, 0, wall)[2], HOVER_M);
});

test("a leap over a wall presses no deeper than the hand does, and climbs no faster than a hand", () => {
  const start: Vec = [-0.03, 0, -PRESS_M];
  const way = [start, ...path(start, [0.04, 0], -PRESS_M)];
  for (let i = 1; i < way.length; i++) {
    const [x, y, z] = way[i]!;
    assert.ok(wall.height(x, y) - z <= PRESS_M + 1e-5, `${wall.height(x, y) - z} m deep at ${x}`);
    assert.ok(z - way[i - 1]![2] <= SPEED.climb * STEP_S + 1e-9, "up");
    assert.ok(way[i - 1]![2] - z <= SPEED.sink * STEP_S + 1e-9, "down");
    assert.ok(x - way[i - 1]![0] <= SPEED.moveOverSurface * STEP_S + 1e-9, "along");
  }
  assert.ok(Math.hypot(way.at(-1)![0] - 0.04, way.at(-1)![2] - (0.01 - PRESS_M)) < 1e-6, "it arrives");
  const climbing = way.filter(([x]) => x > 0.0099 && x < 0.0106).length;
  assert.ok(climbing * STEP_S > (0.8 * 0.01) / SPEED.climb, "the wall takes its time");
});

test("it falls off a wall no faster than a hand", () => {
  const start: Vec = [0.03, 0, 0.01 - PRESS_M];
  const way = [start, ...path(start, [-0.03, 0], -PRESS_M)];
  for (let i = 1; i < way.length; i++) assert.ok(way[i - 1]![2] - way[i]![2] <= SPEED.sink * STEP_S + 1e-9);
  assert.ok(Math.abs(way.at(-1)![2] + PRESS_M) < 1e-9);
});

test("a place at the rim, and beside it, is within the rim", () => {
  for (const [x, y] of [[0.05, 0.03], [-0.3, -0.3], [0.05, 0]] as const) {
    const at = path(null, [x, y], -PRESS_M, wall, 200).at(-1)!;
    const [u, v] = clampToRim(wall, x, y);
    assert.ok(Math.hypot(at[0] - u, at[1] - v) < 1e-9);
    assert.ok(Math.abs(at[0]) < 0.05 && Math.abs(at[1]) < 0.03);
    assert.ok(Math.abs(wall.height(u, v) - PRESS_M - at[2]) < 1e-9);
  }
  const speck: Ground = { meta: { extent_m: [0.01, 0.01], height_m: [0, 0], columns: 1 }, height: () => 0 };
  assert.deepEqual(clampToRim(speck, 0, 0), [0, 0]);
});

test("in a region that is felt enlarged the hand is as much slower", () => {
  const start: Vec = [-0.03, 0, 0];
  assert.ok(Math.abs(nextPosition(start, { over: [0.04, 0], gapM: 0 }, STEP_S, wall, 4)[0] + 0.03 - (SPEED.moveOverSurface * STEP_S) / 4) < 1e-9);
  assert.equal(magnificationOf({ region_m: [0, 0, 0.02, 0.03] }, [0.1, 0.06]), 2);
  assert.equal(magnificationOf({ region_m: [0, 0, 0.02, 0.03], scale: 3 }, [0.1, 0.06]), 3);
  assert.equal(magnificationOf({}, [0.1, 0.06]), 1);
});

test("in space it goes straight on, no faster than a hand, and not out of reach", () => {
  let at: Vec = [0, 0, 0.02];
  for (let i = 0; i < 200; i++) {
    const next = nextPosition(at, { at: [-0.2, 0, -1] }, STEP_S, wall);
    assert.ok(Math.hypot(next[0] - at[0], next[1] - at[1], next[2] - at[2]) <= SPEED.free * STEP_S + 1e-9);
    at = next;
  }
  assert.ok(Math.hypot(at[0] + 0.07, at[1], at[2] + 0.01) < 1e-9, String(at));
});

test("keys: a tap is a step, held ones move by a speed, and the keyboard's repeat changes nothing", () => {
  const keys = new HeldKeys();
  assert.deepEqual(keys.down("ArrowRight", ALONE, 0), [PACES.plain.stepM, 0, 0]);
  for (let ms = 30; ms < HELD_MS; ms += 30) assert.deepEqual(keys.down("ArrowRight", ALONE, ms), [0, 0, 0]);
  assert.deepEqual(keys.way(0.016, HELD_MS - 1), [0, 0, 0]);
  let far = 0;
  for (let ms = HELD_MS; ms < HELD_MS + 1000; ms += 20) {
    keys.down("ArrowRight", ALONE, ms);
    far += keys.way(0.02, ms)[0];
  }
  assert.ok(Math.abs(far - PACES.plain.mPerS) < 1e-9, "a second of its speed");
  keys.down("ArrowUp", { shiftKey: true, ctrlKey: false }, 2000);
  const [x, y] = keys.way(1, 3000);
  assert.ok(Math.abs(Math.hypot(x, y) - PACES.fine.mPerS) < 1e-9, "two at once are no faster, and Shift is fine");
  keys.up("ArrowRight", ALONE);
  keys.up("ArrowUp", ALONE);
  assert.deepEqual(keys.way(1, 4000), [0, 0, 0]);
  assert.deepEqual(keys.down("ArrowLeft", { shiftKey: false, ctrlKey: true }, 5000), [-PACES.coarse.stepM, 0, 0]);
  keys.clear();
  assert.deepEqual(keys.way(1, 9000), [0, 0, 0]);
  assert.equal(keys.down("x", ALONE, 9000), null);
});

test("one finger is the hand; of two none is, until all are up", () => {
  const fingers = new Fingers();
  assert.ok(fingers.down(1));
  assert.ok(!fingers.down(2));
  assert.ok(!fingers.isHand(1));
  fingers.up(2);
  assert.ok(!fingers.isHand(1), "the one that stays does not press");
  fingers.up(1);
  assert.ok(fingers.down(3));
});

test("pressure is what the browser says, by force or by size, and nothing where it says the same all the time", () => {
  const dull = new Pressure();
  for (let i = 0; i < 9; i++) assert.equal(dull.share({ pressure: 0.5, width: 20, height: 20 }), null);
  const fine = new Pressure();
  assert.equal(fine.share({ pressure: 0.2, width: 1, height: 1 }), null);
  fine.share({ pressure: 0.3, width: 1, height: 1 });
  assert.equal(fine.share({ pressure: 0.4, width: 1, height: 1 }), 0.4);
  const wide = new Pressure();
  wide.share({ pressure: 1, width: 10, height: 10 });
  wide.share({ pressure: 1, width: 30, height: 30 });
  assert.equal(wide.share({ pressure: 1, width: 20, height: 20 }), 0.5);
});

const up = { pressed: false, value: 0 };
const BUTTONS = Array.from({ length: 17 }, () => up);
const pressing = (which: number, value: number) => BUTTONS.map((each, i) => (i === which ? { pressed: true, value } : each));

test("a game pad at rest moves nothing; the stick moves in all directions alike, the trigger presses", () => {
  assert.deepEqual(readPad({ axes: [DEAD_ZONE, 0, 0, -DEAD_ZONE], buttons: BUTTONS }), { x: 0, y: 0, z: 0, press: 0 });
  const right = readPad({ axes: [1, 0, 0, 0], buttons: BUTTONS });
  const away = readPad({ axes: [0, -1, 0, 0], buttons: BUTTONS });
  assert.ok(right.x > 0.05 && right.y === 0);
  assert.ok(Math.abs(away.y - right.x) < 1e-12);
  assert.ok(readPad({ axes: [0, 0, 0, 1], buttons: BUTTONS }).z < 0);
  assert.equal(readPad({ axes: [], buttons: pressing(7, 0.6) }).press, 0.6);
});

test("a button of a game pad acts once", () => {
  const presses = new Presses();
  const pressed = { axes: [], buttons: pressing(1, 1) };
  assert.deepEqual(presses.newPresses(pressed), [1]);
  assert.deepEqual(presses.newPresses(pressed), []);
  assert.deepEqual(presses.newPresses({ axes: [], buttons: BUTTONS }), []);
  assert.deepEqual(presses.newPresses(pressed), [1]);
});

test("a game pad shakes with the force, up to its limit, and is still at once without", () => {
  const said: (number | "still")[] = [];
  const shaker = {
    playEffect: (_: string, { strongMagnitude }: { strongMagnitude: number }) => said.push(strongMagnitude),
    reset: () => said.push("still"),
  };
  const shake = new Rumble();
  shake.play(shaker, 0, 0);
  shake.play(shaker, 2, 10);
  shake.play(shaker, 2, 20); // too soon
  shake.play(shaker, 80, 100);
  shake.play(shaker, NaN, 110);
  shake.play(shaker, 0, 120);
  shake.play(shaker, 1, 121);
  shake.stop(shaker);
  assert.deepEqual(said, [0.4, 0.8, "still", 0.2, "still"]);
});

test("a part is found in its widest place", () => {
  // two parts side by side, a third of one place in a corner, and nothing beyond
  const label = (x: number, y: number): number | null => (x > 0.045 ? null : x > 0.04 && y > 0.025 ? 9 : x < 0 ? 2 : 5);
  const parts = findPartCentres(label, [0.1, 0.06]);
  assert.deepEqual(parts.map((each) => each.label), [2, 5, 9]);
  for (const { label: each, at } of parts) assert.equal(label(...at), each);
  assert.ok(Math.abs(parts[0]!.at[0] + 0.025) < 0.01 && Math.abs(parts[0]!.at[1]) < 0.01);
  assert.deepEqual(findPartCentres(() => null, [0.1, 0.06]), []);
});

test("a ray meets a level before it, or not at all", () => {
  assert.deepEqual(meetLevel([0, 0, 1], [0, 0, -1], 0.25), [0, 0, 0.25]);
  assert.equal(meetLevel([0, 0, 1], [0, 0, 1], 0.25), null);
  assert.equal(meetLevel([0, 0, 1], [1, 0, 0], 0.25), null);
});
