"""A hand would be kicked where it enters, leaves, leaps or comes from the side of the block."""

from dataclasses import replace

import numpy as np
import pytest

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import NO_FORCE, Force, HapticState, HapticSurface, Material
from tangible_core.plugins.interfaces import Touch
from tangible_core.testing.synthetic.scenes import plane, ramp
from tangible_render.proxy import Proxy

RNG = np.random.default_rng(23)
K = 800.0
LEVEL = plane(0.01).surface
GLUE = Proxy(static_friction=50.0, dynamic_friction=50.0)
"""A friction that holds the proxy in its first place, so that the force shows that place."""


def at(touch: Touch, x: float, y: float, z: float, velocity=(0.0, 0.0, 0.0)) -> Force:
    return touch.force(HapticState((float(x), float(y), float(z)), velocity))


class TestWays:
    @pytest.mark.parametrize("slope", [(0.0, 0.0), (0.5, 0.0), (-1.5, 0.8)])
    def test_contact_starts_within_a_64th_of_the_crossing(self, slope: tuple[float, float]):
        """The start is on the hand's side, so that no energy is stored that was not given."""
        known, starts = ramp(slope, 0.1), []
        for _ in range(100):
            x, y, dx, dy, dz = RNG.uniform(-1, 1, 5) * (0.02, 0.02, 0.0028, 0.0028, 0.0028)
            outside = np.array(known.at(x, y, -abs(dz) - 1e-6))
            inside = np.array(known.at(x + dx, y + dy, 0.002))
            if np.linalg.norm(inside - outside) > 0.0049:
                continue
            touch = GLUE.touch(known.surface)
            assert at(touch, *outside) == NO_FORCE
            way = (inside - outside)[:2]
            proxy = inside[:2] + np.array(at(touch, *inside))[:2] / K
            assert (proxy - outside[:2]) @ (-way[1], way[0]) == pytest.approx(0, abs=1e-9)
            over = abs(dz) + 1e-6
            crosses, starts_at = over / (over + 0.002), way @ (proxy - outside[:2]) / (way @ way)
            starts.append(crosses - starts_at)
        assert min(starts) >= -1e-4 and max(starts) <= 1 / 64 + 1e-4
        assert len(starts) > 20 and max(starts) > 1 / 128  # it is searched for in halves

    def test_hand_from_the_side_is_pushed_back_until_over_the_rim(self):
        touch = Proxy().touch(LEVEL)
        assert at(touch, 0.041, 0.002, 0.004) == NO_FORCE
        assert at(touch, 0.039, 0.003, 0.004) == pytest.approx((K * 0.001, 0, 0), abs=1e-9)
        assert at(touch, 0.038, 0.004, 0.007) == pytest.approx((K * 0.002, 0, 0), abs=1e-9)
        assert at(touch, 0.038, 0.004, 0.0105) == NO_FORCE
        assert at(touch, 0.038, 0.004, 0.0095) == pytest.approx((0, 0, K * 0.0005), abs=1e-4)

    def test_wall_does_not_push_the_hand_out_at_its_far_side(self):
        heights = np.zeros((256, 256))
        heights[:, 100:116] = 0.01  # 5 mm thick
        touch = Proxy().touch(HapticSurface.from_heights(heights))
        x = np.linspace(-0.012, -0.005, 200)
        force = touch.path(np.column_stack([x, np.zeros(200), np.full(200, 0.005)]))
        assert (force[:, 0] <= 1e-9).all() and force[-1, 0] < -1.0

    def test_proxy_below_a_farther_surface_is_not_released(self):
        """At a depth of 24 mm the proxy is released beyond that distance, not beyond 20 mm."""
        z, x = np.linspace(0.0099, -0.014, 30), np.append(np.linspace(0, 0.0238, 30), 0.0242)
        path = np.vstack([np.column_stack([0 * z, 0 * z, z]), np.column_stack([x, 0 * x, np.full(31, -0.014)])])
        force = GLUE.touch(LEVEL).path(path)
        assert force[-2] == pytest.approx((-K * 0.0238, 0, K * 0.024), abs=1e-5)
        assert force[-1] == pytest.approx((0, 0, K * 0.024), abs=1e-5)

    @pytest.mark.parametrize("axis", range(3))
    def test_hand_moving_5_mm_in_a_tick_starts_anew(self, axis: int):
        for leap_m, held in ((0.0049, True), (0.0051, False)):
            hand, touch = np.array((0.001, 0.001, 0.0)), GLUE.touch(LEVEL)
            at(touch, 0.0, 0.0, 0.0)
            assert at(touch, *hand) == pytest.approx((-K * 0.001, -K * 0.001, K * 0.01), abs=1e-5)
            hand[axis] -= leap_m
            x, y, z = hand if held else (0.0, 0.0, hand[2])
            assert at(touch, *hand) == pytest.approx((-K * x, -K * y, K * (0.01 - z)), abs=1e-5)

    def test_proxy_moves_two_millimetres_a_tick_at_most(self):
        """There are eight steps of a quarter: after a hand that moved by 4.5 mm it arrives in the third tick."""
        touch = Proxy(damping_n_s_per_m=1e-300).touch(LEVEL)
        at(touch, 0.0, 0.0, 0.009)
        for behind_m in (0.0025, 0.0005, 0.0):
            assert at(touch, 0.0027, 0.0036, 0.009) == pytest.approx(
                (-K * behind_m * 0.6, -K * behind_m * 0.8, K * 0.001), abs=1e-6
            )

    @pytest.mark.parametrize(
        "other", [{}, {"damping_n_s_per_m": 1.0}, {"roughness_m": 1e-4}], ids=["spring", "damped", "textured"]
    )
    def test_force_not_finite_is_zero(self, other: dict[str, float]):
        rock = replace(Material("rock", 1e308, 0.0, 0.0, 0.0), **other)
        surface = HapticSurface.from_heights(np.full((8, 8), 0.01), 0.08, np.zeros((8, 8), np.int32), (rock,))
        touch = Proxy().touch(surface)
        assert at(touch, 0.0, 0.0, 0.009).z > 1e300
        assert at(touch, 0.0, 0.0, -1000.0) == NO_FORCE
        assert at(touch, 0.0, 0.0, 0.009).z > 1e300

    def test_proxy_without_contact_is_absent(self):
        for renderer in (Proxy(), Proxy(static_friction=0.5, dynamic_friction=0.5)):
            touch = renderer.touch(LEVEL)
            assert isinstance(touch, CompiledTouch)
            at(touch, 0.01, 0.02, 0.009)
            assert touch.memory[:3] == pytest.approx((0.01, 0.02, 0.01))
            for elsewhere in ((0.01, 0.02, 0.011), (0.5, 0.02, 0.009), (np.nan, 0.02, 0.009)):
                at(touch, *elsewhere)
                assert np.isnan(touch.memory[2])
                at(touch, 0.01, 0.02, 0.009)
