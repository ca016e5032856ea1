"""Checks of slopes and of the force, on flights whose verdicts are known; each cure is applied."""

import math
from typing import Any

import numpy as np
import pytest

from flights import fly, grades, half_slope, level, material, of, shape, surface_with_materials, value_in_cure
from tangible_core import HapticSurface
from tangible_core.data import Relief
from tangible_core.preflight.checks.clipping import clipping, contact
from tangible_core.preflight.checks.slopes import cliffs, slope_stiffness, slopes
from tangible_core.scene.geometry import smooth
from tangible_core.servo.guard.safety import Safety


class TestSlopes:
    def test_too_stiff_half_of_the_surface_is_unsafe(self):
        """Along the gradient, slope 2 makes 5000 N/m of 1000, over the limit of 4000; at the bend it is 2000."""
        [found] = slope_stiffness(fly(half_slope(2.0, cells=64), "penalty-gradient", stiffness_n_per_m=1000.0))
        assert (found.verdict, found.value) == ("unsafe", pytest.approx(0.5, abs=1 / 64))
        assert "up to 5000 N/m" in found.note
        softer = value_in_cure(found, "render.stiffness_n_per_m")
        assert softer == 790
        again = fly(half_slope(2.0, cells=64), "penalty-gradient", stiffness_n_per_m=softer)
        assert grades(slope_stiffness(again)) == ["ok"]

    def test_steep_surface_is_smoothed_and_not_softened(self):
        """Slope 9.4 makes 90,000 N/m of 1000: a stable law would have 44 N/m on level ground."""
        surface = shape(lambda x, y: 0.03 * np.sin(2 * np.pi * x / 0.02), 256)
        [found] = slope_stiffness(fly(surface, "penalty-gradient", stiffness_n_per_m=1000.0))
        assert found.verdict == "unsafe"
        assert "stiffness_n_per_m" not in found.cure
        rounder = smooth(surface.relief, value_in_cure(found, "workspace.smooth_m"))
        assert np.mean(slopes(rounder) > np.sqrt(3)) <= 0.001

    @pytest.mark.parametrize("cure", [{"law": "proxy"}, {"law": "penalty-gradient", "safety": Safety(coupling="auto")}])
    def test_too_stiff_other_cures_pass(self, cure: dict[str, Any]):
        assert grades(slope_stiffness(fly(half_slope(2.0, cells=64), stiffness_n_per_m=1000.0, **cure))) == ["ok"]

    @pytest.mark.parametrize(
        ("law", "fitted", "cure"),
        [
            ("proxy", True, "`safety.coupling: auto`"),
            ("proxy", False, "`materials.fit: device`; or `safety.coupling: auto`"),
            (
                "penalty",
                True,
                "`safety.coupling: auto`; or a force law that slopes do not stiffen, `render.use: proxy`",
            ),
        ],
    )
    def test_cures_already_applied_are_left_out(self, law: str, fitted: bool, cure: str):
        flight = fly(surface_with_materials(material()), law, fitted=fitted)
        object.__setattr__(flight.probes, "stiffness_n_per_m", np.full(4, 9000.0))
        [found] = slope_stiffness(flight)
        assert found.cure == cure

    @pytest.mark.parametrize(("stiffness", "verdict"), [(4040.0, "ok"), (4050.0, "unsafe")])
    def test_measured_stiffness_may_exceed_the_limit_by_a_hundredth(self, stiffness: float, verdict: str):
        flight = fly(level())
        object.__setattr__(flight.probes, "stiffness_n_per_m", np.full(4, stiffness))
        assert grades(slope_stiffness(flight)) == [verdict]

    def test_too_stiff_few_places_are_a_warning(self):
        surface = shape(lambda x, y: np.where((abs(x) < 2e-3) & (abs(y) < 2e-3), 0.005, 0.0), 64)
        [found] = slope_stiffness(fly(surface, "penalty-gradient", stiffness_n_per_m=1000.0))
        assert found.verdict == "warn"
        assert 0 < found.value <= 0.01

    @pytest.mark.parametrize(("slope", "verdict"), [(0.99, "ok"), (1.01, "warn")])
    def test_walls_are_graded_by_their_slope(self, slope: float, verdict: str):
        found = of(cliffs(fly(half_slope(slope))), "a wall")
        assert found.verdict == verdict
        assert found.value == pytest.approx(0.5 if verdict == "warn" else 0, abs=0.02)

    def test_sudden_force_is_a_warning(self):
        """1000 N/m at 0.25 m/s and 1 kHz meet slope 2 with 0.5 N a tick."""
        stroke = {"stiffness_n_per_m": 1000.0, "speed_m_per_s": 0.25}
        assert of(cliffs(fly(half_slope(1.99), **stroke)), "too sudden").verdict == "ok"
        assert of(cliffs(fly(half_slope(2.01), **stroke)), "too sudden").verdict == "warn"
        assert [each.of for each in cliffs(fly(half_slope(2.01), "grey-level"))] == ["a wall"]

    def test_wall_both_cures_pass(self):
        surface = shape(lambda x, y: 0.01 * np.sin(2 * np.pi * x / 0.02), 256)
        rounder = smooth(surface.relief, value_in_cure(of(cliffs(fly(surface)), "a wall"), "workspace.smooth_m"))
        assert np.mean(slopes(rounder) > 1) <= 0.1
        given = of(cliffs(fly(surface, smoothed=False)), "a wall")
        lower = value_in_cure(given, "workspace.relief_m") / 0.02
        assert np.mean(slopes(HapticSurface.from_heights(lower * surface.height_m).relief) > 1) <= 0.1
        assert "smooth_m" not in given.cure
        of_parts = of(cliffs(fly(surface, smoothed=False, relief_key="")), "a wall")
        assert (of_parts.cure, of_parts.changes) == ("lower parts (`height_m` under `parts:`)", ())
        both = of(cliffs(fly(surface, relief_key="")), "a wall")
        assert both.cure.endswith(", or lower parts (`height_m` under `parts:`)")
        assert [each.key for each in both.changes] == ["workspace.smooth_m"]

    def test_slopes_take_the_greater_side(self):
        step = HapticSurface.from_heights(np.array([[0, 0, 0.01, 0.01]], np.float32), 0.04)
        np.testing.assert_allclose(slopes(step.relief), [[0, 1, 1, 0]], rtol=1e-6)
        assert slopes(Relief(np.zeros((1, 1), np.float32), (0.1, 0.1))).tolist() == [[0]]


class TestClipping:
    def test_clipping_half_of_the_surface_has_cures_that_pass(self):
        """A press of 3 N on slope 3 is answered with 9.5 N; at the bend, slope 1.5, with 5.4 N."""
        surface = half_slope(3.0, cells=64)
        flight = fly(surface, "penalty-gradient", relief_m=0.12)
        [found] = clipping(flight)
        assert (found.verdict, found.value) == ("warn", pytest.approx(0.5, abs=1 / 64))
        lower = value_in_cure(found, "workspace.relief_m") / 0.12
        assert 3 * math.hypot(1, 3 * lower) == pytest.approx(8, rel=0.05)
        gentler = HapticSurface.from_heights(lower * surface.height_m)
        assert grades(clipping(fly(gentler, "penalty-gradient"))) == ["ok"]

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
