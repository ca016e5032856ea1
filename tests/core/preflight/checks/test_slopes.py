"""Checks of slopes and force. Otherwise a hand would meet a sudden force, and the advice would not help."""

import math
import re

import numpy as np
import pytest

from flights import fly, grades, half_slope, level, material, of, shape, surface_with_materials, value_in_cure
from tangible_core import HapticSurface
from tangible_core.data import Relief
from tangible_core.preflight.checks.slopes import cliffs, climbable, clipping, contact, slope_stiffness, slopes
from tangible_core.scene.geometry import smooth
from tangible_core.servo.guard.safety import Safety


def waves(amplitude_m: float) -> HapticSurface:
    """Return waves along x, 20 mm long; the steepest slope is 314 amplitude_m."""
    return shape(lambda x, y: amplitude_m * np.sin(2 * np.pi * x / 0.02), 256)


def blocks(run: int) -> HapticSurface:
    """Return blocks 5 mm high and 8 mm wide whose walls are `run` cells of 0.3 mm wide."""
    return shape(
        lambda x, y: 0.005 * np.clip(0.5 + (0.004 - np.abs(x % 0.016 - 0.008)) / (run * 0.08 / 256), 0, 1), 256
    )


class TestSlopes:
    def test_slope_that_is_too_stiff_is_unsafe_and_smoothed(self):
        """Along the gradient, slope 2 makes 5000 N/m of 1000, over the limit of 4000; at the bend it is 2000."""
        surface, penalty = half_slope(2.0, cells=64), "penalty-gradient"
        [found] = slope_stiffness(fly(surface, penalty, stiffness_n_per_m=1000.0))
        assert (found.verdict, found.value) == ("unsafe", pytest.approx(0.5, abs=1 / 64))
        assert "up to 5000 N/m" in found.note
        softer = value_in_cure(found, "render.stiffness_n_per_m")
        assert softer == 790
        assert grades(slope_stiffness(fly(surface, penalty, stiffness_n_per_m=softer))) == ["ok"]
        assert grades(slope_stiffness(fly(surface, "proxy", stiffness_n_per_m=1000.0))) == ["ok"]
        coupled = fly(surface, penalty, stiffness_n_per_m=1000.0, safety=Safety(coupling="auto"))
        assert grades(slope_stiffness(coupled)) == ["ok"]
        surface = shape(lambda x, y: 0.03 * np.sin(2 * np.pi * x / 0.02), 256)
        [found] = slope_stiffness(fly(surface, "penalty-gradient", stiffness_n_per_m=1000.0))
        assert found.verdict == "unsafe"
        assert "stiffness_n_per_m" not in found.cure
        rounder = smooth(surface.relief, value_in_cure(found, "workspace.smooth_m"))
        assert np.mean(slopes(rounder) > np.sqrt(3)) <= 0.001

    @pytest.mark.parametrize(("stiffness", "verdict"), [(4040.0, "ok"), (4050.0, "unsafe")])
    def test_measured_stiffness_may_exceed_the_limit_by_a_hundredth(self, stiffness: float, verdict: str):
        cures = {}
        for law in ("proxy", "penalty"):
            flight = fly(surface_with_materials(material()), law, fitted=True)
            object.__setattr__(flight.probes, "stiffness_n_per_m", np.full(4, stiffness))
            [found] = slope_stiffness(flight)
            cures[law] = found.cure
            assert found.verdict == verdict
        if verdict == "unsafe":
            assert cures["proxy"] == "`safety.coupling: auto`"
            assert cures["penalty"].startswith(cures["proxy"]) and "`render.use: proxy`" in cures["penalty"]

    @pytest.mark.parametrize(("amplitude_m", "verdict"), [(0.0025, "ok"), (0.02, "warn")])
    def test_walls_are_graded_by_how_long_they_hold_a_hand_up(self, amplitude_m: float, verdict: str):
        """Waves of slope 0.8, which a hand climbs, and of 6.3, which it does not."""
        assert of(cliffs(fly(waves(amplitude_m))), "a wall").verdict == verdict

    def test_walls_and_friction_hold_a_hand_up(self):
        """A share of the surface would fall, as a steeper wall has less area."""
        gentle, steep, upright = (of(cliffs(fly(blocks(run))), "a wall").value for run in (12, 4, 1))
        assert gentle == 0 < steep < upright
        wave = waves(0.005)
        rough = HapticSurface(
            wave.relief, np.zeros(wave.height_m.shape, np.int32), (material(static_friction=0.7, dynamic_friction=0.7),)
        )
        smooth, held = (of(cliffs(fly(each)), "a wall") for each in (wave, rough))
        assert (smooth.verdict, held.verdict) == ("ok", "warn")
        assert climbable(fly(rough)) == pytest.approx((2 - 0.7) / (1 + 2 * 0.7))
        assert climbable(fly(wave)) == 2

    def test_slopes_take_the_greater_side_and_the_force_of_the_law(self):
        """A penalty of 1000 N/m at 0.25 m/s and 1 kHz grows by 0.25 N a tick times the slope, a proxy by 0.25 N."""
        stroke = {"stiffness_n_per_m": 1000.0, "speed_m_per_s": 0.25}
        penalty = of(cliffs(fly(half_slope(5.0), "penalty", **stroke)), "too sudden")
        proxy = of(cliffs(fly(half_slope(5.0), "proxy", **stroke)), "too sudden")
        assert (penalty.verdict, proxy.verdict, proxy.value) == ("warn", "ok", 0)
        assert float(re.search(r"up to ([\d.]+) N in a tick", proxy.note)[1]) < 0.5
        assert [cliff.of for cliff in cliffs(fly(half_slope(1.0), "grey-level"))] == ["a wall", "too sudden"]
        step = HapticSurface.from_heights(np.array([[0, 0, 0.01, 0.01]], np.float32), 0.04)
        np.testing.assert_allclose(slopes(step.relief), [[0, 1, 1, 0]], rtol=1e-6)
        assert slopes(Relief(np.zeros((1, 1), np.float32), (0.1, 0.1))).tolist() == [[0]]
        assert "relief.slope" not in of(cliffs(fly(waves(0.02), slope=1.5)), "a wall").cure, "gentle enough already"

    def test_wall_is_cured_by_slope_then_rounding_then_height(self):
        surface = waves(0.02)
        limited = of(cliffs(fly(surface, slope=0.0)), "a wall")
        assert [(change.key, float(change.value)) for change in limited.changes] == [("relief.slope", 2.0)]
        rounded = of(cliffs(fly(surface)), "a wall")
        assert [change.key for change in rounded.changes] == ["workspace.smooth_m"]
        rounder = smooth(surface.relief, value_in_cure(rounded, "workspace.smooth_m"))
        assert np.mean(slopes(rounder) > 2) <= 0.001
        given = of(cliffs(fly(surface, smoothed=False)), "a wall")
        lower = value_in_cure(given, "workspace.relief_m") / 0.02
        assert np.mean(slopes(HapticSurface.from_heights(lower * surface.height_m).relief) > 2) <= 0.001
        assert "smooth_m" not in given.cure
        of_parts = of(cliffs(fly(surface, smoothed=False, of_parts=True)), "a wall")
        assert (of_parts.cure, of_parts.changes) == ("lower parts (`height_m` under `parts:`)", ())
        both = of(cliffs(fly(surface, of_parts=True)), "a wall")
        assert both.cure.endswith(", or lower parts (`height_m` under `parts:`)")
        assert [change.key for change in both.changes] == ["workspace.smooth_m"]


class TestClipping:
    def test_clipping_half_of_the_surface_has_cures_that_pass(self):
        """A press of 3 N on slope 1.8 is answered with 6.2 N, on slope 1.5 with 5.4 N."""
        surface, device = half_slope(1.8, cells=64), {"max_force_n": 5.5}
        flight = fly(surface, "penalty-gradient", relief_m=0.12, device=device)
        [found] = clipping(flight)
        assert (found.verdict, found.value) == ("warn", pytest.approx(0.5, abs=1 / 64))
        lower = value_in_cure(found, "workspace.relief_m") / 0.12
        assert 3 * math.hypot(1, 1.8 * lower) == pytest.approx(5.5, rel=0.05)
        gentler = HapticSurface.from_heights(lower * surface.height_m)
        assert grades(clipping(fly(gentler, "penalty-gradient", device=device))) == ["ok"]
        [shaped] = clipping(fly(surface, "penalty-gradient", slope=1.8, device=device))
        assert value_in_cure(shaped, "relief.slope") == pytest.approx(math.sqrt((5.5 / 3) ** 2 - 1), rel=0.05)

    @pytest.mark.parametrize(("slope", "share"), [(1.8, 0.5), (2.3, 0.06)])
    def test_clipping_leaves_out_walls_at_which_no_hand_stays(self, slope: float, share: float):
        """A hand pushes sideways with at most twice its press; what is left is the bend at the foot of the wall."""
        [found] = clipping(fly(half_slope(slope, cells=64), max_force_n=5.5))
        assert found.value == pytest.approx(share, abs=0.06)

    @pytest.mark.parametrize(("press_n", "verdict", "share"), [(4.0, "ok", 0), (4.01, "warn", 1)])
    def test_clipping_press_above_the_device_is_graded(self, press_n: float, verdict: str, share: float):
        [found] = clipping(fly(level(), press_n=press_n, safety=Safety(max_force_n=4.001)))
        assert (found.verdict, found.value) == (verdict, share)
        if verdict == "warn":
            assert "no more than 4 N" in found.cure
            assert "relief_m" not in found.cure

    def test_contact_force_that_steps_is_a_warning(self):
        [spring] = contact(fly(level(), "proxy"))
        [step] = contact(fly(level(), "grey-level", force_at_white_n=2.0))
        assert (spring.verdict, step.verdict, step.value) == ("ok", "warn", pytest.approx(2))
        softer = value_in_cure(step, "render.force_at_white_n")
        assert grades(contact(fly(level(), "grey-level", force_at_white_n=softer))) == ["ok"]
