"""The guard of a force, exactly, tick by tick: if it fails, a device pushes a hand harder than it was allowed to."""

import math

import numpy as np
import pytest

from tangible_core.data import DeviceSpec, TickFlag
from tangible_core.servo.guard.guard import couple, guard, restart, wait
from tangible_core.servo.guard.layout import ENERGY_J, MAX_DELAY
from tangible_core.servo.guard.safety import Coupling, Safety, counts

SPEC = DeviceSpec(8.0, 3000.0, 1.5, (0.08, 0.08, 0.08), 3e-5)
BARE = {"ramp_s": 0, "passivity": "off"}
"""Safety without any limit but those of a test."""
AT_ONCE = {"ramp_s": 0, "max_step_n": 10}
NAN = math.nan


def ticks(safety: Safety, forces, stiffness: float = 0.0, period_s: float = 0.001, velocity=(0.0, 0.0, 0.0)):
    """Return the guarded forces on a hand at rest, their flags, and the memory."""
    settings, memory = safety.arrays(SPEC, stiffness)
    left = [guard(settings, memory, period_s, 0.0, 0.0, 0.0, *velocity, *force) for force in forces]
    return np.array([each[:3] for each in left]), [TickFlag(each[3]) for each in left], memory


class TestMaximum:
    def test_clipped_force_keeps_its_direction_at_the_lesser_maximum(self):
        forces, flags, _ = ticks(Safety(max_step_n=10, **BARE), [(30.0, -40.0, 120.0)])
        np.testing.assert_allclose(forces[0], np.array([3, -4, 12]) * 8 / 13, rtol=1e-15)
        assert flags == [TickFlag.TOUCHING | TickFlag.FORCE_LIMITED]
        for asked, given_n in ((2.0, 2.0), (50.0, 8.0)):
            forces, _, _ = ticks(Safety(max_force_n=asked, max_step_n=10, **BARE), [(0.0, 0.0, 100.0)])
            assert forces[0, 2] == given_n

    @pytest.mark.parametrize("huge", [1e200, 1e308, -1e308])
    def test_force_whose_square_overflows_is_clipped(self, huge: float):
        forces, flags, _ = ticks(Safety(max_step_n=10, **BARE), [(huge, huge, 0.0)])
        np.testing.assert_allclose(forces[0], [math.copysign(math.sqrt(32), huge)] * 2 + [0], rtol=1e-15)
        assert TickFlag.FORCE_LIMITED in flags[0]


class TestSlew:
    def test_slew_limited_steps_are_exact(self):
        forces, flags, _ = ticks(Safety(max_step_n=0.5, **BARE), [(0.0, 0.0, 1.75)] * 5)
        assert forces[:, 2].tolist() == [0.5, 1.0, 1.5, 1.75, 1.75]
        assert [TickFlag.SLEW_LIMITED in flag for flag in flags] == [True] * 3 + [False] * 2

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_step_starts_at_the_last_force_along_each_axis(self, axis: int):
        along = np.eye(3)[axis]
        forces, _, _ = ticks(Safety(max_step_n=0.5, **BARE), np.outer([0.5, 1.0, 1.75, 0.75], along))
        assert forces.tolist() == np.outer([0.5, 1.0, 1.5, 1.0], along).tolist()

    @pytest.mark.parametrize(("period_s", "step_n"), [(0.00025, 0.125), (0.001, 0.5), (0.004, 0.5)])
    def test_slew_limit_is_proportional_in_short_ticks_and_constant_in_long_ones(self, period_s: float, step_n: float):
        forces, _, _ = ticks(Safety(max_step_n=0.5, **BARE), [(0.0, 5.0, 0.0)], period_s=period_s)
        assert forces[0, 1] == step_n

    @pytest.mark.parametrize("period_s", [0.0, -1.0, 1e-9])
    def test_period_zero_or_negative_counts_as_ten_microseconds(self, period_s: float):
        forces, _, memory = ticks(Safety(max_step_n=0.5, ramp_s=0), [(0.0, 5.0, 0.0)] * 3, 800.0, period_s)
        np.testing.assert_allclose(forces[:, 1], [0.005, 0.010, 0.015], rtol=1e-12)
        assert np.isfinite(memory[ENERGY_J])


class TestRamp:
    def test_force_fades_in_at_first_and_after_a_swap(self):
        forces, flags, _ = ticks(Safety(ramp_s=0.004, passivity="off"), [(0.0, 0.0, 0.4)] * 5)
        np.testing.assert_allclose(forces[:, 2], [0.1, 0.2, 0.3, 0.4, 0.4], rtol=1e-15)
        assert [TickFlag.RAMPING in flag for flag in flags] == [True] * 3 + [False] * 2
        settings, memory = Safety(ramp_s=0.1, passivity="off", max_step_n=0.25).arrays(SPEC, 0.0)
        for _ in range(150):
            guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 1.0)
        restart(memory)
        fz = [guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 1.0)[2] for _ in range(100)]
        np.testing.assert_allclose(fz[:4], [0.75, 0.5, 0.25, 0.04], atol=1e-15)
        np.testing.assert_allclose(fz[-1], 1.0)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_force_along_any_axis_counts_as_touch(axis: int):
    _, flags, memory = ticks(Safety(**BARE), [(0.0, 0.0, 0.0), tuple(0.1 * np.eye(3)[axis])])
    assert flags == [TickFlag(0), TickFlag.TOUCHING]
    assert counts(memory) == {TickFlag.TOUCHING: 1}


BAD = [NAN, math.inf, -math.inf]


class TestNotFinite:
    @pytest.mark.parametrize("bad", BAD)
    @pytest.mark.parametrize("place", range(10))
    def test_value_not_finite_gives_zero_force_at_once(self, place: int, bad: float):
        settings, memory = Safety(ramp_s=0).arrays(SPEC, 500.0)
        good = [0.001, *[0.0] * 6, 0.0, 0.0, 5.0]
        for _ in range(20):
            guard(settings, memory, *good)
        broken = list(good)
        broken[place] = bad
        assert guard(settings, memory, *broken) == (0.0, 0.0, 0.0, TickFlag.NOT_FINITE)
        assert guard(settings, memory, *good)[2] == 0.5
        assert counts(memory)[TickFlag.NOT_FINITE] == 1

    def test_force_after_value_not_finite_fades_in_again(self):
        settings, memory = Safety(ramp_s=0.01).arrays(SPEC, 0.0)
        good = [0.001, *[0.0] * 6, 0.0, 0.0, 0.4]
        for _ in range(20):
            guard(settings, memory, *good)
        guard(settings, memory, *[NAN] * 10)
        assert guard(settings, memory, *good)[2] == pytest.approx(0.04)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_force_after_stop_rises_from_zero(self, axis: int):
        settings, memory = Safety(**BARE).arrays(SPEC, 0.0)
        push = 3.0 * np.eye(3)[axis]
        for _ in range(4):
            guard(settings, memory, 0.001, *[0.0] * 6, *push)
        guard(settings, memory, *[NAN] * 10)
        assert wait(settings, memory, 0.001)[:3] == (0.0, 0.0, 0.0)
        assert guard(settings, memory, 0.001, *[0.0] * 6, *push)[axis] == 0.5


def stopped(memory: np.ndarray, settings: np.ndarray) -> None:
    """A tick that is not finite."""
    assert guard(settings, memory, *[NAN] * 10)[3] == TickFlag.NOT_FINITE


class TestMemoryAfterStop:
    @pytest.mark.parametrize("delay", [0, 1, 3, MAX_DELAY])
    def test_delayed_forces_are_cleared_by_stop(self, delay: int):
        """A force that would have arrived after the stop does no work."""
        settings, memory = Safety(passivity="strict", delay_ticks=delay, **AT_ONCE).arrays(SPEC, 0.0)
        for _ in range(2 * MAX_DELAY + 2):
            guard(settings, memory, 0.001, *[0.0] * 6, 1.0, 1.0, 1.0)
        stopped(memory, settings)
        for i in range(MAX_DELAY + 1):
            guard(settings, memory, 0.001, 0.001 * i, 0.001 * i, 0.001 * i, *[0.0] * 6)
            assert memory[ENERGY_J] == 0.0

    def test_device_position_is_cleared_by_stop(self):
        settings, memory = Safety(**AT_ONCE).arrays(SPEC, 0.0)
        guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 1e-9)
        stopped(memory, settings)
        guard(settings, memory, 0.001, 0.005, *[0.0] * 5, 0.0, 0.0, 1e-9)
        assert memory[ENERGY_J] == 0.0

    @pytest.mark.parametrize("ended", [stopped, lambda memory, _: restart(memory)])
    def test_energy_debt_and_tool_are_cleared_by_stop(self, ended):
        settings, memory = Safety(passivity="strict", coupling="auto", **AT_ONCE).arrays(SPEC, 500.0)
        state = (0.001, 0.002, 0.003, 0.1, 0.2, 0.3)
        for push in (1.0, 2.0):
            couple(settings, memory, 0.001, *[0.0] * 6)
            guard(settings, memory, 0.001, *[0.0] * 6, push, 0.0, 0.0)
        memory[ENERGY_J] = -1e-3
        assert couple(settings, memory, 0.001, *state) != state
        ended(memory, settings)
        assert memory[ENERGY_J] == 0.0
        assert couple(settings, memory, 0.001, *state) == state


class TestStale:
    def test_last_force_without_positions_is_held_then_cut(self):
        settings, memory = Safety(stale_s=0.0045, **BARE).arrays(SPEC, 0.0)
        guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 0.4)
        held = [wait(settings, memory, 0.001) for _ in range(6)]
        assert held[:4] == [(0.0, 0.0, 0.4, 0)] * 4
        assert held[4:] == [(0.0, 0.0, 0.0, TickFlag.STALE)] * 2

    def test_position_at_the_age_limit_is_not_stale_and_waits_count(self):
        settings, memory = Safety(stale_s=0.0625, max_step_n=10, **BARE).arrays(SPEC, 0.0)
        push = (*[0.0] * 6, 0.1, 0.2, 0.4)
        for period_s in (0.001, 0.0625):
            assert guard(settings, memory, period_s, *push)[:3] == (0.1, 0.2, 0.4)
        for _ in range(2):
            assert wait(settings, memory, 0.03125) == (0.1, 0.2, 0.4, 0)
        assert wait(settings, memory, 2**-20)[3] == TickFlag.STALE
        settings, memory = Safety(max_step_n=0.5, **BARE).arrays(SPEC, 0.0)
        push = (*[0.0] * 6, 5.0, 0.0, 0.0)
        assert guard(settings, memory, 0.00025, *push)[0] == 0.125
        for _ in range(3):
            wait(settings, memory, 0.00025)
        assert guard(settings, memory, 0.00025, *push)[0] == 0.625
        assert guard(settings, memory, 0.00025, *push)[0] == 0.75
        settings, memory = Safety(stale_s=0.005, **BARE).arrays(SPEC, 0.0)
        push = (*[0.0] * 6, 0.4, 0.0, 0.0)
        guard(settings, memory, 0.001, *push)
        for _ in range(4):
            assert wait(settings, memory, 0.001)[0] == 0.4
        assert guard(settings, memory, 0.0015, *push)[3] == TickFlag.STALE
        assert guard(settings, memory, 0.004, *push)[0] == 0.4

    @pytest.mark.parametrize("period_s", [NAN, math.inf, -1e-9, -1.0])
    def test_broken_clock_is_stale(self, period_s: float):
        settings, memory = Safety(**BARE).arrays(SPEC, 0.0)
        guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 0.4)
        assert wait(settings, memory, period_s) == (0.0, 0.0, 0.0, TickFlag.STALE)


class TestStiffnessLimit:
    def test_force_of_too_stiff_law_is_scaled_to_the_limit(self):
        # 0.8 of 2 b / T is 2400 N/m: a law of 4800 leaves half of its force.
        forces, flags, _ = ticks(Safety(**BARE), [(0.0, 0.0, 0.4)], stiffness=4800.0)
        assert forces[0, 2] == pytest.approx(0.2, rel=1e-12)
        assert flags == [TickFlag.TOUCHING | TickFlag.STIFFNESS_LIMITED]

    @pytest.mark.parametrize("delay", [0, 1, 2])
    def test_stiffness_limit_follows_the_measured_period(self, delay: int):
        safety = Safety(delay_ticks=delay, **BARE)
        forces, _, _ = ticks(safety, [(0.0, 0.0, 0.4)] * 2500, stiffness=2000.0, period_s=0.004)
        assert forces[-1, 2] == pytest.approx(0.4 * 0.8 * 2 * 1.5 / 0.004 / (1 + 2 * delay) / 2000, rel=1e-6)

    def test_gain_rises_slowly_and_falls_quickly_in_contact_alone(self):
        settings, memory = Safety(**BARE).arrays(SPEC, 2000.0)
        push = (*[0.0] * 6, 0.0, 0.0, 0.4)
        slow = np.array([guard(settings, memory, 0.004, *push)[2] for _ in range(1000)]) / 0.4
        quick = np.array([guard(settings, memory, 0.001, *push)[2] for _ in range(3000)]) / 0.4
        assert slow[-1] == pytest.approx(0.3, rel=1e-3)
        assert np.diff(slow).min() >= -0.004 / 0.05 - 1e-12
        assert 0 < np.diff(quick).max() <= 0.001 / 1.0 + 1e-12
        assert quick[-1] == 1.0
        safety = Safety(coupling=Coupling(stiffness_n_per_m=4800, damping_n_s_per_m=0), max_step_n=10, **BARE)
        settings, memory = safety.arrays(SPEC, 0.0)
        couple(settings, memory, 0.001, *[0.0] * 6)
        away = (-0.001, *[0.0] * 5)
        assert guard(settings, memory, 0.001, *away, 0.0, 0.0, 0.0) == pytest.approx((4.8, 0.0, 0.0, 0))
        assert (
            guard(settings, memory, 0.001, *away, 0.0, 0.0, 1e-9)[3] == TickFlag.TOUCHING | TickFlag.STIFFNESS_LIMITED
        )

    def test_gain_after_one_long_tick_is_exact_by_the_mean_square(self):
        """The mean of T is 1 + 2 / 128 ms, that of its square 1 + 8 / 128 ms^2: 2294 N/m are stable, of 2390."""
        settings, memory = Safety(**BARE).arrays(SPEC, 2390.0)
        held = 2.4 * (0.001 + 0.002 / 128) / (1e-6 + 8e-6 / 128)
        assert guard(settings, memory, 0.003, *[0.0] * 6, 0.0, 0.0, 0.4)[2] == pytest.approx(0.4 * held / 2390)
        settings, memory = Safety(**BARE).arrays(SPEC, 3000.0)
        left = [guard(settings, memory, 0.0005 if i % 2 else 0.0015, *[0.0] * 6, 0.0, 0.0, 0.4)[2] for i in range(4000)]
        # E[T^2] / E[T] is 1.25 ms; the share stays where the clock was worst
        assert left[-1] == pytest.approx(0.4 * 0.8 * 3 / 0.00125 / 3000, rel=5e-3)
        assert np.ptp(left[-500:]) < 1e-12

    def test_encoder_limit_does_not_depend_on_the_period(self):
        """2 f / Delta is 2000 N/m, of which 1600 may be used."""
        forces, _, _ = ticks(Safety(friction_n=0.03, **BARE), [(0.0, 0.0, 0.4)] * 500, stiffness=2000.0)
        np.testing.assert_allclose(forces[:, 2], 0.4 * 1600 / 2000)
