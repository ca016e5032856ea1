"""Every check on a flight whose verdict is known, and its cure applied."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flights import fly, half_slope, level, material, of, shape
from tangible_core import HapticSurface
from tangible_core.data import Relief
from tangible_core.preflight import CHECKS, judge
from tangible_core.preflight.bumps import threshold_m
from tangible_core.preflight.checks.clipping import clipping, contact
from tangible_core.preflight.checks.device import damping, friction, workspace
from tangible_core.preflight.checks.features import features, textures
from tangible_core.preflight.checks.jitter import lateness, tick_cost
from tangible_core.preflight.checks.slopes import cliffs, slope_stiffness, slopes
from tangible_core.preflight.checks.stiffness import law_damping, law_stiffness, material_stiffness, quantisation
from tangible_core.preflight.timing import Lateness, TickCost
from tangible_core.preflight.verdict import Verdict, check_bound
from tangible_core.scene.geometry import smooth
from tangible_core.servo.guard.safety import Safety


def grades(verdicts: Any) -> list[str]:
    return [each.verdict for each in verdicts]


def value_in_cure(verdict: Verdict, key: str) -> float:
    """Return the value of a key in the text of the cure."""
    return float(re.search(rf"{re.escape(key)}: ([\d.e-]+)", verdict.cure)[1])


def surface_with_materials(*materials: Any) -> HapticSurface:
    """Return level ground with a stripe of each material."""
    labels = (np.arange(32) * len(materials) // 32).astype(np.int32)
    return level(labels=np.tile(labels, (32, 1)), materials=materials)


class TestTextures:
    @pytest.mark.parametrize(
        ("grain_m", "verdict", "said"),
        [
            (1.2e-3, "ok", "10 samples"),
            (6e-4, "ok", "5 samples"),
            (5.9e-4, "warn", "4.92 samples a wave"),
            (2.4e-4, "warn", "2 samples a wave: none"),
        ],
    )
    def test_grain_is_graded_at_012_m_per_s_and_1_khz(self, grain_m: float, verdict: str, said: str):
        rough = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=grain_m)
        found = of(textures(fly(surface_with_materials(rough))), "rough")
        assert (found.verdict, said in found.note) == (verdict, True)

    def test_fine_grain_has_two_cures(self):
        rough = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=4e-4)
        found = of(textures(fly(surface_with_materials(rough))), "rough")
        better = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=value_in_cure(found, "grain_m"))
        assert of(textures(fly(surface_with_materials(better))), "rough").verdict == "ok"
        assert "slower than 0.08 m/s" in found.cure
        assert of(textures(fly(surface_with_materials(rough), speed_m_per_s=0.08)), "rough").verdict == "ok"

    def test_coarse_device_samples_at_its_resolution(self):
        rough = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=1e-3)
        found = of(textures(fly(surface_with_materials(rough), resolution_m=3e-4)), "rough")
        assert (found.verdict, found.bound) == ("warn", pytest.approx(1.5e-3))

    def test_only_present_materials_with_a_grain_are_checked(self):
        slipping = material("slipping", texture="stick-slip", static_friction=0.5, dynamic_friction=0.4, grain_m=1e-4)
        labels = np.where(np.arange(32) < 16, 0, 2).astype(np.int32)
        others = material("smooth"), material("elsewhere", texture="stochastic", roughness_m=1e-4), slipping
        surface = level(labels=np.tile(labels, (32, 1)), materials=others)
        assert [each.of for each in textures(fly(surface))] == ["shortest wave", "slipping"]

    def test_surface_without_materials_has_one_verdict(self):
        [only] = textures(fly(level(), speed_m_per_s=0.1, period_s=0.002))
        assert (only.verdict, only.value) == ("ok", pytest.approx(4e-4))


class TestStiffness:
    """The device renders 4000 N/m by its damping, of which the guard leaves 3200; its specification has 10,000 N/m."""

    @pytest.mark.parametrize(("stiffness", "verdict"), [(3200, "ok"), (3201, "warn"), (4000, "warn"), (4001, "unsafe")])
    def test_stiffness_is_graded_by_the_damping(self, stiffness: float, verdict: str):
        found, _ = law_stiffness(fly(level(), stiffness_n_per_m=stiffness))
        assert (found.verdict, found.bound) == (verdict, 3200)

    def test_soft_law_is_a_warning(self):
        soft, *_ = law_stiffness(fly(level(), stiffness_n_per_m=0.26))
        assert (soft.verdict, soft.says) == ("warn", "the force law is so soft that a hand goes through the surface")

    @pytest.mark.parametrize(
        ("changes", "limit"),
        [
            ({"period_s": 0.002}, 2000),
            ({"safety": Safety(delay_ticks=1)}, 4000 / 3),
            ({"device": {"damping_n_s_per_m": 0.5}}, 1000),
            ({"max_stiffness_n_per_m": 1000.0}, 1000),
            ({"max_stiffness_n_per_m": 1000.0, "period_s": 0.004}, 250),
            ({"safety": Safety(friction_n=0.02), "resolution_m": 2e-5}, 2000),
        ],
    )
    def test_lowest_limit_comes_first(self, changes: dict[str, Any], limit: float):
        flight = fly(level(), **changes)
        assert flight.ceilings[0].limit_n_per_m == pytest.approx(limit)

    def test_friction_limit_has_the_margin(self):
        """2 f / resolution is 2000 N/m, of which the guard leaves 1600."""
        coarse = {"safety": Safety(friction_n=0.02), "resolution_m": 2e-5}
        for stiffness, verdict in ((1600.0, "ok"), (1601.0, "warn"), (2001.0, "unsafe")):
            found, *_ = law_stiffness(fly(level(), stiffness_n_per_m=stiffness, **coarse))
            assert (found.verdict, found.bound) == (verdict, pytest.approx(1600))
            assert found.source.startswith("Abbott")

    def test_lowest_ceiling_is_after_the_margin(self):
        """3300 N/m by friction leave 2640; the specification of the device, 3000 N/m, has no margin."""
        coarse = {"safety": Safety(friction_n=0.033), "resolution_m": 2e-5, "max_stiffness_n_per_m": 3000.0}
        left = [each.most_n_per_m for each in fly(level(), **coarse).ceilings]
        assert left == pytest.approx([2400, 2640, 3000])

    def test_fast_loop_has_the_limit_of_the_device(self):
        limits = [each.limit_n_per_m for each in fly(level(), max_stiffness_n_per_m=3000.0, period_s=0.00025).ceilings]
        assert sorted(limits) == pytest.approx([3000, 12_000])

    @pytest.mark.parametrize(("asked", "given_n"), [(None, 8.0), (2.0, 2.0), (50.0, 8.0)])
    def test_max_force_is_the_lesser_of_device_and_option(self, asked: float | None, given_n: float):
        assert fly(level(), safety=Safety(max_force_n=asked)).max_force_n == given_n

    @pytest.mark.parametrize(("period_s", "step_n"), [(0.00025, 0.125), (0.001, 0.5), (0.004, 0.5)])
    def test_max_step_is_that_of_the_guard(self, period_s: float, step_n: float):
        assert fly(level(), period_s=period_s).max_step_n == step_n

    def test_stiffness_cure_passes(self):
        flight = fly(level(), stiffness_n_per_m=20_000.0)
        verdicts = list(law_stiffness(flight))
        assert grades(verdicts) == ["unsafe", "unsafe"]
        for verdict in verdicts:
            softer = fly(level(), stiffness_n_per_m=value_in_cure(verdict, "render.stiffness_n_per_m"))
            assert next(each for each in law_stiffness(softer) if each.source == verdict.source).verdict == "ok"

    def test_coupling_lowers_the_stiffness_at_the_device(self):
        flight = fly(level(), stiffness_n_per_m=20_000.0, safety=Safety(coupling="auto"))
        assert grades(law_stiffness(flight)) == ["ok", "ok"]
        assert flight.felt_n_per_m(1600.0) == pytest.approx(800)

    def test_stiff_material_is_named_and_cured_in_the_library(self):
        surface = surface_with_materials(material("soft"), material("hard", stiffness_n_per_m=5000.0))
        [unfitted, *_] = law_stiffness(fly(surface))
        assert unfitted.cure == "`materials.fit: device`"
        flight = fly(surface, fitted=True)
        [law, *_] = law_stiffness(flight)
        assert "`hard: {stiffness_n_per_m: 3200}`" in law.cure
        assert "soft" not in law.cure
        verdicts = list(material_stiffness(flight))
        assert [(each.of, each.verdict) for each in verdicts] == [("soft", "ok"), ("hard", "unsafe")]
        assert value_in_cure(verdicts[1], "stiffness_n_per_m") == 3200

    def test_texture_is_clean_up_to_900_n_per_m(self):
        rough = {"texture": "stochastic", "roughness_m": 1e-4}
        pair = material("clean", **rough, stiffness_n_per_m=900.0), material("buzzes", **rough, stiffness_n_per_m=950.0)
        clean, buzzes = material_stiffness(fly(surface_with_materials(*pair)))
        assert (clean.verdict, buzzes.verdict) == ("ok", "warn")
        assert value_in_cure(buzzes, "stiffness_n_per_m") == 900

    def test_rough_material_too_stiff_for_the_device_is_unsafe(self):
        rough = material(texture="stochastic", roughness_m=1e-4, stiffness_n_per_m=5000.0)
        [found] = material_stiffness(fly(surface_with_materials(rough)))
        assert found.verdict == "unsafe"

    @pytest.mark.parametrize(("own", "verdict"), [(1.0, "ok"), (1.01, "warn")])
    def test_damping_is_graded_with_the_stiffness(self, own: float, verdict: str):
        """b > K T / 2 + B, with b 2 N s/m and K 2000 N/m."""
        flight = fly(level(), "penalty-gradient", stiffness_n_per_m=2000.0)
        object.__setattr__(flight.probes, "damping_n_s_per_m", np.full_like(flight.probes.damping_n_s_per_m, own))
        [found] = law_damping(flight)
        assert (found.verdict, found.bound) == (verdict, pytest.approx(1.0))

    def test_damping_bound_falls_with_delay(self):
        """b > K T (1 + 2 d) / 2 + B, with b 2 N s/m, K 1000 N/m and d 1."""
        flight = fly(level(), "penalty-gradient", stiffness_n_per_m=1000.0, safety=Safety(delay_ticks=1))
        [found] = law_damping(flight)
        assert found.bound == pytest.approx(0.5)

    def test_damping_bound_of_a_law_too_stiff_is_zero(self):
        [found] = law_damping(fly(level(), "penalty-gradient", stiffness_n_per_m=6000.0))
        assert found.bound == 0

    @pytest.mark.parametrize(("places", "verdict"), [(2, "ok"), (15, "warn")])
    def test_damping_at_a_few_places_is_ignored(self, places: int, verdict: str):
        flight = fly(level(), "penalty-gradient", stiffness_n_per_m=2000.0)
        object.__setattr__(flight.probes, "stiffness_n_per_m", np.full(1000, 2000.0))
        object.__setattr__(flight.probes, "damping_n_s_per_m", np.where(np.arange(1000) < places, 9.0, 0.5))
        [found] = law_damping(flight)
        assert (found.verdict, found.value) == (verdict, 0.5 if verdict == "ok" else 9.0)

    def test_damping_bound_follows_the_stiffness_of_each_place(self):
        """b is 2 N s/m: 500 N/m leave 1.75 of it, 3000 N/m leave 0.5."""
        soft, hard = {"stiffness_n_per_m": 500.0}, {"stiffness_n_per_m": 3000.0}
        pair = material("soft", damping_n_s_per_m=1.6, **soft), material("hard", damping_n_s_per_m=0.4, **hard)
        assert grades(law_damping(fly(surface_with_materials(*pair)))) == ["ok"]
        swapped = material("soft", damping_n_s_per_m=0.4, **soft), material("hard", damping_n_s_per_m=1.6, **hard)
        [found] = law_damping(fly(surface_with_materials(*swapped)))
        assert (found.verdict, found.value) == ("warn", pytest.approx(1.6, rel=0.01))
        assert found.bound == pytest.approx(0.5, rel=0.01)

    def test_coupling_lowers_damping_that_changes_fast(self):
        """The coupling's damping is a quarter of the device's 2 N s/m: with 3 N s/m, 0.43 of it is felt."""
        flight = fly(level(), "penalty-gradient", damping_n_s_per_m=3.0, safety=Safety(coupling="auto"))
        [found] = law_damping(flight)
        assert (found.verdict, found.value) == ("ok", pytest.approx(3.0 * 0.5 / 3.5, rel=0.01))

    def test_encoder_step_that_is_felt_is_a_warning(self):
        [fine] = quantisation(fly(level(), stiffness_n_per_m=800.0, press_n=1.0, resolution_m=8.75e-5))
        [coarse] = quantisation(fly(level(), stiffness_n_per_m=800.0, press_n=1.0, resolution_m=9e-5))
        assert (fine.verdict, coarse.verdict) == ("ok", "warn")
        softer = value_in_cure(coarse, "render.stiffness_n_per_m")
        assert grades(quantisation(fly(level(), stiffness_n_per_m=softer, press_n=1.0, resolution_m=9e-5))) == ["ok"]

    def test_device_without_damping_has_its_stated_limit(self):
        flight = fly(level(), device={"damping_n_s_per_m": 0.0}, max_stiffness_n_per_m=1000.0)
        assert flight.ceilings[0].limit_n_per_m == 1000


class TestDevice:
    @pytest.mark.parametrize(
        ("stated", "simulated", "verdict", "taken"),
        [(1.0, False, "ok", 1.0), (20.0, False, "warn", 1.5), (0.0, False, "warn", 1.5), (20.0, True, "ok", 1.5)],
    )
    def test_damping_is_graded_by_plausibility(self, stated: float, simulated: bool, verdict: str, taken: float):
        device = {"damping_n_s_per_m": stated, "simulated": simulated, "max_stiffness_n_per_m": 3000.0}
        [found] = damping(fly(level(), device=device))
        assert (found.verdict, found.value) == (verdict, taken)

    def test_friction_unknown_is_a_warning(self):
        assert grades(friction(fly(level()))) == ["warn"]
        assert grades(friction(fly(level(), simulated=True))) == ["ok"]
        assert grades(friction(fly(level(), safety=Safety(friction_n=0.3)))) == ["ok"]


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


class TestFeatures:
    WAVE_M = 5.17 * 3.2e-3
    """Wavelength of which a band 3.2 mm wide passes 1.74 amplitudes."""

    def wave(self, felt: float, **changes: Any) -> Any:
        """Return a flight over a sine that is `felt` times the threshold for 3.2 mm."""
        amplitude_m = felt * threshold_m(3.2e-3) / 1.741
        cells, width_m = 321, 4.5 * self.WAVE_M
        relief = shape(lambda x, y: amplitude_m * np.sin(2 * np.pi * x / self.WAVE_M + np.pi / 2), cells, width_m)
        return fly(relief, relief_m=2 * amplitude_m, **changes)

    def test_feature_below_the_threshold_has_a_cure(self):
        found = of(features(self.wave(0.9)), "3.2 mm wide")
        assert found.verdict == "warn"
        assert found.value == pytest.approx(0.9 * 29e-6, rel=0.05)
        needed = value_in_cure(found, "workspace.relief_m") / (2 * 0.9 * threshold_m(3.2e-3) / 1.741)
        assert needed == pytest.approx(1 / 0.9, rel=0.08)

    def test_feature_above_the_threshold_passes(self):
        assert of(features(self.wave(1.1)), "3.2 mm wide").verdict == "ok"

    def test_feature_below_the_resolution_fails(self):
        found = of(features(self.wave(1.1, resolution_m=4e-5)), "3.2 mm wide")
        assert (found.verdict, found.bound, found.source) == ("warn", 4e-5, "the device's resolution")

    def test_wide_hill_has_no_narrow_features(self):
        hill = shape(lambda x, y: 0.005 * np.exp(-(x**2 + y**2) / (2 * 0.01**2)), 256)
        assert [(each.of, each.verdict) for each in features(fly(hill))] == [("10 mm wide", "ok"), ("32 mm wide", "ok")]

    @pytest.mark.parametrize(
        "surface", [level(), shape(lambda x, y: 0.1 * x), HapticSurface.from_heights(np.ones((1, 1)))]
    )
    def test_relief_without_a_feature_is_a_warning(self, surface: HapticSurface):
        [found] = features(fly(surface))
        assert (found.of, found.verdict) == ("the relief", "warn")


class TestWorkspace:
    def test_surface_within_reach_passes(self):
        assert grades(workspace(fly(level(0.02), workspace_m=(0.08, 0.08, 0.02)))) == ["ok"] * 3

    def test_surface_beyond_reach_has_cures(self):
        surface = HapticSurface.from_heights(np.full((20, 10), 0.03, np.float32), 0.1)
        width, length, height = workspace(fly(surface, workspace_m=(0.08, 0.08, 0.02), relief_m=0.03))
        assert grades((width, length, height)) == ["warn"] * 3
        assert value_in_cure(width, "workspace.width_m") == 0.08
        assert value_in_cure(length, "workspace.width_m") == 0.04
        assert value_in_cure(height, "workspace.relief_m") == pytest.approx(0.02, rel=0.06)

    @pytest.mark.parametrize(
        ("reach_m", "verdicts"),
        [
            ((0.1, 0.2, 0.03), ["ok", "ok", "ok"]),
            ((0.09, 0.2, 0.03), ["warn", "ok", "ok"]),
            ((0.1, 0.19, 0.03), ["ok", "warn", "ok"]),
            ((0.1, 0.2, 0.029), ["ok", "ok", "warn"]),
            ((0.2, 0.1, 0.03), ["ok", "warn", "ok"]),
        ],
    )
    def test_each_side_is_checked_against_its_reach(self, reach_m: tuple[float, float, float], verdicts: list[str]):
        """100 mm wide, 200 mm long, and 30 mm over the base plane, though the relief itself is level."""
        surface = HapticSurface.from_heights(np.full((20, 10), 0.03, np.float32), 0.1)
        found = list(workspace(fly(surface, workspace_m=reach_m)))
        assert grades(found) == verdicts
        assert [each.bound for each in found] == list(reach_m)


class TestJitter:
    """1000 ticks, of which some are late."""

    def late(self, ticks: int, by_s: float) -> Lateness:
        late_s = np.full(1000, 1e-5)
        late_s[:ticks] = by_s
        return Lateness(late_s, 0.001, real_time=False)

    def test_calm_machine_passes(self):
        assert grades(lateness(fly(level()))) == ["ok"] * 3

    @pytest.mark.parametrize(("ticks", "verdict"), [(1, "ok"), (2, "warn")])
    def test_overruns_are_graded(self, ticks: int, verdict: str):
        found = of(lateness(fly(level(), lateness=self.late(ticks, 0.0011))), "overruns")
        assert (found.verdict, found.value) == (verdict, ticks / 1000)
        assert "ulimit -r" in found.cure or verdict == "ok"

    @pytest.mark.parametrize(
        ("ticks", "by_s", "verdict"), [(1, 0.005, "ok"), (2, 0.000999, "ok"), (2, 0.0011, "warn"), (9, 0.005, "warn")]
    )
    def test_lateness_one_tick_in_a_thousand_is_allowed(self, ticks: int, by_s: float, verdict: str):
        found = of(lateness(fly(level(), lateness=self.late(ticks, by_s))), "lateness, p99.9")
        assert (found.verdict, found.bound) == (verdict, 0.001)

    def test_lateness_of_a_period_is_not_an_overrun(self):
        assert Lateness(np.array([0.0, 0.001, 0.0010001, 0.0]), 0.001, real_time=False).overruns == 0.25

    def test_early_clock_does_not_raise_the_limit(self):
        early = Lateness(np.full(1000, -5e-4), 0.001, real_time=True)
        found = of(lateness(fly(level(), lateness=early)), "stiffness it leaves")
        assert found.bound == pytest.approx(4000)

    @pytest.mark.parametrize(("slow", "verdict"), [(0.005, "ok"), (0.02, "warn"), (0.4, "warn"), (0.6, "unsafe")])
    def test_slow_ticks_some_are_a_warning_and_most_are_unsafe(self, slow: float, verdict: str):
        """1.1 ms, where a period is one: the rest are quick."""
        call_s = np.where(np.arange(1000) < 1000 * slow, 1.1e-3, 1e-6)
        [found] = tick_cost(fly(level(), cost=TickCost(call_s, 1e-6)))
        assert found.verdict == verdict

    @pytest.mark.parametrize(("simulated", "verdict"), [(False, "unsafe"), (True, "warn")])
    def test_stiffness_with_lateness_is_graded(self, simulated: bool, verdict: str):
        """b = 2 N s/m: periods of 1 + 4 ms leave 800 N/m."""
        late = {"lateness": self.late(10, 0.004), "simulated": simulated}
        ok = of(lateness(fly(level(), stiffness_n_per_m=800.0, **late)), "stiffness it leaves")
        worse = of(lateness(fly(level(), stiffness_n_per_m=801.0, **late)), "stiffness it leaves")
        assert (ok.verdict, ok.bound) == ("ok", pytest.approx(800))
        assert worse.verdict == verdict
        assert bool(worse.changes) != simulated  # a busy moment of this machine is nothing to write into a file

    @pytest.mark.parametrize(
        ("call_s", "simulated", "verdict"),
        [(5e-4, False, "ok"), (6e-4, False, "warn"), (1.1e-3, False, "unsafe"), (1.1e-3, True, "warn")],
    )
    def test_tick_is_graded_against_its_period(self, call_s: float, simulated: bool, verdict: str):
        cost = TickCost(np.full(100, call_s), 1e-6)
        [found] = tick_cost(fly(level(), cost=cost, simulated=simulated))
        assert found.verdict == verdict
        assert verdict == "ok" or found.cure == "a lighter force law (`render.use`), or stop other work on this machine"

    def test_tick_of_a_python_law_is_not_called_compiled(self):
        [found] = tick_cost(fly(level(), cost=TickCost(np.full(100, 6e-4), 6e-4, compiled=False)))
        assert "compiled" not in found.note
        assert found.cure.startswith("a force law of compiled kernels instead of Python")


def test_page_names_every_check():
    page = Path(__file__).parents[3].joinpath("docs/preflight.md").read_text(encoding="utf-8")
    for each in judge(fly(surface_with_materials(material(texture="stochastic", roughness_m=1e-4)))):
        assert f"| {each.check} |" in page


@pytest.mark.parametrize("law", ["proxy", "penalty-gradient", "grey-level", "tangible-mask", "lateral-gradient"])
@pytest.mark.parametrize(
    "surface",
    [HapticSurface.from_heights(np.zeros((1, 1))), level(), half_slope(5.0, 32)],
    ids=["pixel", "level", "half"],
)
def test_checks_all_yield_verdicts_and_failures_have_cures(law: str, surface: HapticSurface):
    flight = fly(surface, law)
    verdicts = judge(flight)
    assert len(verdicts) >= len(CHECKS) - 3
    for each in verdicts:
        assert (each.verdict == "ok") == (each.cure == "") == (each.says == ""), each
        assert "proxy" not in each.cure or law != "proxy", each
        assert math.isfinite(each.value)


@pytest.mark.parametrize("relation", ["<=", ">="])
def test_check_bound_nan_meets_no_bound(relation: Any):
    assert check_bound("check", "of", math.nan, relation, 1.0, "N", "", cure="measure it").verdict == "warn"
    assert check_bound("check", "of", 1.0, relation, math.nan, "N", "", cure="measure it").verdict == "warn"


def test_law_that_is_not_a_spring_has_no_stiffness_limit():
    for law in ("grey-level", "tangible-mask"):
        [found] = law_stiffness(fly(level(), law))
        assert (found.verdict, found.value) == ("ok", 0)
        assert not list(quantisation(fly(level(), law)))
        assert "stiffness it leaves" not in {each.of for each in lateness(fly(level(), law))}
