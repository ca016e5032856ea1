import assert from "node:assert/strict";
import { describe, test } from "node:test";
import type { Material } from "kit/server/messages";
import type { Vec } from "kit/server/protocol";
import { force_level, grains_hz, makeup, MAX_LEVEL, pan, pitch_hz, stroke, tap } from "kit/sound/sonification";

const CLOTH: Material = {
  name: "cloth",
  stiffness_n_per_m: 300,
  damping_n_s_per_m: 0,
  static_friction: 0.6,
  dynamic_friction: 0.4,
  roughness_m: 5e-5,
  grain_m: 4e-4,
  texture: "stochastic",
  direction_deg: 0,
  anisotropy: 0,
  irregularity: 0,
  drag_n_s_per_m: 0,
};
const PRESS: Vec = [0, 0, 1];
const SLOW: Vec = [0.04, 0, 0];
const of = (changed: Partial<Material>): Material => ({ ...CLOTH, ...changed });
const loud = ({ noise, tone }: ReturnType<typeof stroke>): number => noise.level + tone.level;

describe("a stroke", () => {
  test("is silent at rest, without force, in the air, and on what is smooth", () => {
    assert.equal(loud(stroke(CLOTH, PRESS, [0, 0, 0])), 0);
    assert.equal(loud(stroke(CLOTH, PRESS, [0, 0, 1])), 0);
    assert.equal(loud(stroke(CLOTH, [0, 0, 0], SLOW)), 0);
    assert.equal(loud(stroke(null, PRESS, SLOW)), 0);
    assert.equal(loud(stroke(of({ texture: "smooth", roughness_m: 0 }), PRESS, SLOW)), 0);
    assert.equal(loud(stroke(CLOTH, [NaN, 0, 0], SLOW)), 0);
    assert.equal(loud(stroke(CLOTH, PRESS, [NaN, 0, 0])), 0);
  });

  test("is as high as speed over grain", () => {
    assert.equal(stroke(CLOTH, PRESS, SLOW).noise.hz, 100);
    assert.equal(stroke(CLOTH, PRESS, [0.08, 0, 0]).noise.hz, 200);
    assert.equal(stroke(of({ grain_m: 8e-4 }), PRESS, SLOW).noise.hz, 50);
    assert.equal(stroke(of({ grain_m: 1e-9 }), PRESS, SLOW).noise.hz, 6000);
  });

  test("is the louder the rougher, the faster and the stronger, to a limit", () => {
    const before = loud(stroke(CLOTH, PRESS, SLOW));
    assert.ok(before > 0.02);
    assert.ok(loud(stroke(of({ roughness_m: 1e-4 }), PRESS, SLOW)) > before);
    assert.ok(loud(stroke(CLOTH, [0, 0, 2], SLOW)) > before);
    assert.ok(loud(stroke(CLOTH, PRESS, [0.08, 0, 0])) > before);
    assert.equal(stroke(of({ roughness_m: 1 }), [0, 0, 1e9], [1e9, 0, 0]).noise.level, MAX_LEVEL);
  });

  test("along the lines of a material meets no grain", () => {
    const lines = of({ texture: "periodic", anisotropy: 1, direction_deg: 90 });
    assert.ok(Math.abs(grains_hz(lines, [0.04, 0.3, 0]) - 100) < 1e-9);
    assert.equal(loud(stroke(of({ texture: "periodic", anisotropy: 1, direction_deg: 0 }), PRESS, [0.3, 0, 0])), 0);
    assert.ok(Math.abs(grains_hz(of({ anisotropy: 0 }), [0.03, 0.04, 0]) - 125) < 1e-9);
  });

  test("of a periodic texture is a tone, of a stochastic one noise", () => {
    const periodic = stroke(of({ texture: "periodic" }), PRESS, SLOW);
    const stochastic = stroke(CLOTH, PRESS, SLOW);
    assert.ok(periodic.tone.level > periodic.noise.level && periodic.noise.q > stochastic.noise.q);
    assert.ok(stochastic.tone.level === 0 && stochastic.noise.level > 0);
  });

  test("creaks where friction sticks and slips, by what it loses", () => {
    const creak = stroke(of({ texture: "stick-slip" }), PRESS, SLOW);
    assert.ok(creak.creaks && creak.tone.level > 0);
    assert.equal(stroke(of({ texture: "stick-slip", static_friction: 0.4 }), PRESS, SLOW).tone.level, 0);
  });

  test("through a liquid is low, and as loud as the drag", () => {
    const drag = stroke(of({ texture: "drag", roughness_m: 0, drag_n_s_per_m: 10 }), PRESS, SLOW);
    assert.equal(drag.noise.hz, 180);
    assert.ok(stroke(of({ texture: "drag", roughness_m: 0, drag_n_s_per_m: 20 }), PRESS, SLOW).noise.level > drag.noise.level);
  });
});

test("a tap is higher and shorter on what is stiffer, louder when it is faster", () => {
  const soft = tap(CLOTH, [0, 0, -0.05]);
  const hard = tap(of({ stiffness_n_per_m: 3000 }), [0, 0, -0.05]);
  assert.ok(hard.hz > 2 * soft.hz && hard.seconds < soft.seconds);
  assert.ok(tap(CLOTH, [0, 0, -0.1]).level > soft.level);
  assert.ok(tap(null, [0, 0, -9]).level <= MAX_LEVEL);
});

test("heights are two octaves, and a flat surface one tone", () => {
  assert.equal(pitch_hz(0, [0, 0.01]), 220);
  assert.equal(pitch_hz(0.005, [0, 0.01]), 440);
  assert.equal(pitch_hz(0.01, [0, 0.01]), 880);
  assert.equal(pitch_hz(1, [0, 0.01]), 880);
  assert.equal(pitch_hz(0, [0, 0]), 220);
});

test("sides and forces stay within what can be heard", () => {
  assert.deepEqual([-1, -0.04, 0, 0.02, 1].map((x) => pan(x, 0.08)), [-1, -1, 0, 0.5, 1]);
  assert.equal(force_level(0), 0);
  assert.ok(force_level(4) > force_level(1) && force_level(1e6) <= MAX_LEVEL / 2);
  const band = { hz: 500, q: 0.9, level: 1 };
  assert.ok(makeup({ ...band, hz: 100 }, 48_000) > makeup(band, 48_000));
  assert.ok(makeup({ ...band, hz: 1e-9 }, 48_000) < 60);
});
