"""The checks together, of features and of the machine. Otherwise a problem would be missed, or have no cure."""

import math
from typing import Any

import numpy as np
import pytest

from flights import fly, grades, half_slope, level, material, of, shape, surface_with_materials, value_in_cure
from tangible_core import HapticSurface, Workspace
from tangible_core.data import Relief
from tangible_core.preflight import CHECKS, judge
from tangible_core.preflight.bumps import threshold_m
from tangible_core.preflight.checks.cures import flatten, narrow
from tangible_core.preflight.checks.device import damping, friction, lateness, tick_cost, workspace
from tangible_core.preflight.checks.features import features, textures
from tangible_core.preflight.checks.stiffness import law_stiffness, quantisation
from tangible_core.preflight.timing import Lateness, TickCost
from tangible_core.preflight.verdict import check_bound
from tangible_core.servo.guard.safety import Safety


@pytest.mark.parametrize("law", ["proxy", "penalty-gradient", "grey-level", "tangible-mask", "lateral-gradient"])
@pytest.mark.parametrize("surface", [level(cells=1), half_slope(5.0, 32)], ids=["pixel", "half"])
def test_checks_all_yield_verdicts_and_failures_have_cures(law: str, surface: HapticSurface):
    verdicts = judge(fly(surface, law))
    assert len(verdicts) >= len(CHECKS) - 3
    for verdict in verdicts:
        assert (verdict.verdict == "ok") == (verdict.cure == "") == (verdict.says == ""), verdict
        assert "proxy" not in verdict.cure or law != "proxy", verdict
        assert math.isfinite(verdict.value)


@pytest.mark.parametrize("relation", ["<=", ">="])
def test_check_bound_nan_meets_no_bound(relation: Any):
    assert check_bound("check", "of", math.nan, relation, 1.0, "N", "", cure="measure it").verdict == "warn"
    assert check_bound("check", "of", 1.0, relation, math.nan, "N", "", cure="measure it").verdict == "warn"


def test_surface_at_a_scale_and_laws_without_a_spring_are_told():
    """240 m at 1:2000 are 120 mm; what reaches 60 mm is 1:4000, and half as high is half the exaggeration."""
    size = Workspace(scale="1:2000", exaggeration=2).size("heights")._replace(width_m=0.12)
    flight = fly(level(), size=size, exaggeration=2.0)
    assert str(narrow(flight, "0.06")) == "`workspace.scale: 1:4000`"
    assert str(flatten(flight, 0.5)) == "`workspace.exaggeration: 1`"
    assert str(narrow(fly(level()), "0.06")) == "`workspace.width_m: 0.06`"
    for law in ("grey-level", "tangible-mask"):
        [found] = law_stiffness(fly(level(), law))
        assert (found.verdict, found.value) == ("ok", 0)
        assert not list(quantisation(fly(level(), law)))
        assert "stiffness it leaves" not in {each.of for each in lateness(fly(level(), law))}


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

    def test_grain_of_present_materials_has_two_cures(self):
        rough = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=4e-4)
        found = of(textures(fly(surface_with_materials(rough))), "rough")
        better = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=value_in_cure(found, "grain_m"))
        assert of(textures(fly(surface_with_materials(better))), "rough").verdict == "ok"
        assert "slower than 0.08 m/s" in found.cure
        assert of(textures(fly(surface_with_materials(rough), speed_m_per_s=0.08)), "rough").verdict == "ok"
        coarse = of(textures(fly(surface_with_materials(rough), resolution_m=3e-4)), "rough")
        assert (coarse.verdict, coarse.bound) == ("warn", pytest.approx(1.5e-3))
        [only] = textures(fly(level(), speed_m_per_s=0.1, period_s=0.002))
        assert (only.verdict, only.value) == ("ok", pytest.approx(4e-4))
        slipping = material("slipping", texture="stick-slip", static_friction=0.5, dynamic_friction=0.4, grain_m=1e-4)
        labels = np.where(np.arange(32) < 16, 0, 2).astype(np.int32)
        others = material("smooth"), material("elsewhere", texture="stochastic", roughness_m=1e-4), slipping
        surface = level(labels=np.tile(labels, (32, 1)), materials=others)
        assert [texture.of for texture in textures(fly(surface))] == ["shortest wave", "slipping"]


class TestFeatures:
    WAVE_M = 5.17 * 3.2e-3
    """Wavelength of which a band 3.2 mm wide passes 1.74 amplitudes."""

    def wave(self, felt: float, **changes: Any) -> Any:
        """Return a flight over a sine that is `felt` times the threshold for 3.2 mm."""
        amplitude_m = felt * threshold_m(3.2e-3) / 1.741
        cells, width_m = 321, 4.5 * self.WAVE_M
        relief = shape(lambda x, y: amplitude_m * np.sin(2 * np.pi * x / self.WAVE_M + np.pi / 2), cells, width_m)
        return fly(relief, relief_m=2 * amplitude_m, **changes)

    def test_widths_are_those_that_cells_and_surface_hold(self):
        noise = np.random.default_rng(2).random((40, 400)).astype(np.float32)
        for extent_m, found in (
            ((0.1, 0.02), ["1 mm wide", "3.2 mm wide", "10 mm wide"]),
            ((0.1, 0.0199), ["1 mm wide", "3.2 mm wide"]),
            ((0.1, 0.0201), ["3.2 mm wide", "10 mm wide"]),
        ):
            for turned in (False, True):
                relief = Relief(noise.T.copy(), extent_m[::-1]) if turned else Relief(noise, extent_m)
                widths = [feature.of for feature in features(fly(HapticSurface(relief, None, None)))]
                assert widths == found
        found = of(features(self.wave(0.9)), "3.2 mm wide")
        assert (found.verdict, found.value) == ("warn", pytest.approx(0.9 * 29e-6, rel=0.05))
        needed = value_in_cure(found, "workspace.relief_m") / (2 * 0.9 * threshold_m(3.2e-3) / 1.741)
        assert needed == pytest.approx(1 / 0.9, rel=0.08)
        assert of(features(self.wave(1.1)), "3.2 mm wide").verdict == "ok"
        coarse = of(features(self.wave(1.1, resolution_m=4e-5)), "3.2 mm wide")
        assert (coarse.verdict, coarse.bound, coarse.source) == ("warn", 4e-5, "the device's resolution")

    @pytest.mark.parametrize(
        "surface", [level(), shape(lambda x, y: 0.1 * x), HapticSurface.from_heights(np.ones((1, 1)))]
    )
    def test_relief_without_a_feature_is_a_warning(self, surface: HapticSurface):
        [found] = features(fly(surface))
        assert (found.of, found.verdict) == ("the relief", "warn")


class TestWorkspace:
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


class TestDevice:
    @pytest.mark.parametrize(
        ("stated", "simulated", "verdict", "taken"),
        [(1.0, False, "ok", 1.0), (20.0, False, "warn", 1.5), (0.0, False, "warn", 1.5), (20.0, True, "ok", 1.5)],
    )
    def test_damping_is_graded_by_plausibility(self, stated: float, simulated: bool, verdict: str, taken: float):
        device = {"damping_n_s_per_m": stated, "simulated": simulated, "max_stiffness_n_per_m": 3000.0}
        [found] = damping(fly(level(), device=device))
        assert (found.verdict, found.value) == (verdict, taken)

    def test_friction_of_a_device_is_a_warning_where_unknown(self):
        assert grades(friction(fly(level()))) == ["warn"]
        assert grades(friction(fly(level(), simulated=True))) == ["ok"]
        assert grades(friction(fly(level(), safety=Safety(friction_n=0.3)))) == ["ok"]
        known, unknown = fly(level(), safety=Safety(friction_n=0.3)), fly(level(), max_stiffness_n_per_m=3000.0)
        for flight in (fly(level(), simulated=True), known):
            assert not any(each.note or each.cure or each.says for each in (*damping(flight), *friction(flight)))
        assert [each.value for each in friction(known)] == [0.3]
        assert all(each.cure and each.says for each in friction(unknown))

    @pytest.mark.parametrize(("turned", "of_"), [(False, "width"), (True, "length")])
    def test_surface_beyond_the_reach_is_cured_by_a_width(self, turned: bool, of_: str):
        """120 by 60 mm on a device that reaches 100 by 50 mm, or 200 by 50."""
        surface = HapticSurface.from_heights(np.full((32, 64), 0.02, np.float32), 0.12)
        reach_m = (0.2, 0.05, 0.1) if turned else (0.1, 0.2, 0.015)
        found = list(workspace(fly(surface, workspace_m=reach_m, relief_m=0.03)))
        assert grades(found) == (["ok", "warn", "ok"] if turned else ["warn", "ok", "warn"])
        assert [(change.key, change.value) for change in of(found, of_).changes] == [("workspace.width_m", "0.1")]
        if not turned:
            assert [(change.key, change.value) for change in found[2].changes] == [("workspace.relief_m", "0.022")]


class TestJitter:
    """1000 ticks, of which some are late."""

    def late(self, ticks: int, by_s: float) -> Lateness:
        late_s = np.full(1000, 1e-5)
        late_s[:ticks] = by_s
        return Lateness(late_s, 0.001, real_time=False)

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
