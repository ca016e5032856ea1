"""Checks of the device and this machine. Otherwise a late loop or a weak device would be noticed in the hand only."""

import numpy as np
import pytest

from flights import fly, grades, level, of
from tangible_core import HapticSurface
from tangible_core.preflight.checks.device import damping, friction, lateness, tick_cost, workspace
from tangible_core.preflight.timing import Lateness, TickCost
from tangible_core.servo.guard.safety import Safety


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

    def test_what_is_known_of_a_device_needs_no_cure(self):
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
