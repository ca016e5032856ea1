"""The guard of a force: exact results tick by tick, and limits that hold for any input."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tangible_core.data import DeviceSpec, Force, HapticState, TickFlag
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.servo.guard.guard import couple, guard, restart, wait
from tangible_core.servo.guard.layout import ENERGY_J, MOST_DELAY
from tangible_core.servo.guard.safety import Coupling, Safety, counts
from tangible_core.servo.ticks.python_tick import guard_touch

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
    def test_clipped_force_keeps_its_direction(self):
        forces, flags, _ = ticks(Safety(max_step_n=10, **BARE), [(30.0, -40.0, 120.0)])
        np.testing.assert_allclose(forces[0], np.array([3, -4, 12]) * 8 / 13, rtol=1e-15)
        assert flags == [TickFlag.TOUCHING | TickFlag.FORCE_LIMITED]

    def test_configured_maximum_is_at_most_the_device_maximum(self):
        for asked, given_n in ((2.0, 2.0), (50.0, 8.0)):
            forces, _, _ = ticks(Safety(max_force_n=asked, max_step_n=10, **BARE), [(0.0, 0.0, 100.0)])
            assert forces[0, 2] == given_n

    @pytest.mark.parametrize("huge", [1e200, 1e308, -1e308])
    def test_force_whose_square_overflows_is_clipped(self, huge: float):
        forces, flags, _ = ticks(Safety(max_step_n=10, **BARE), [(huge, huge, 0.0)])
        np.testing.assert_allclose(forces[0], [math.copysign(math.sqrt(32), huge)] * 2 + [0], rtol=1e-15)
        assert TickFlag.FORCE_LIMITED in flags[0]

    def test_force_below_maximum_stays(self):
        wanted = (0.1, 0.2, -0.3)
        forces, flags, _ = ticks(Safety(**BARE), [wanted])
        assert tuple(forces[0]) == wanted
        assert flags == [TickFlag.TOUCHING]


class TestSlew:
    def test_slew_limited_steps_are_exact(self):
        forces, flags, _ = ticks(Safety(max_step_n=0.5, **BARE), [(0.0, 0.0, 1.75)] * 5)
        assert forces[:, 2].tolist() == [0.5, 1.0, 1.5, 1.75, 1.75]
        assert [TickFlag.SLEW_LIMITED in each for each in flags] == [True] * 3 + [False] * 2

    def test_falling_force_has_the_same_slew_limit(self):
        forces, _, _ = ticks(Safety(max_step_n=0.5, **BARE), [(1.0, 0.0, 0.0)] * 2 + [(-1.0, 0.0, 0.0)] * 3)
        assert forces[:, 0].tolist() == [0.5, 1.0, 0.5, 0.0, -0.5]

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
    def test_force_fades_in_by_the_clock(self):
        forces, flags, _ = ticks(Safety(ramp_s=0.004, passivity="off"), [(0.0, 0.0, 0.4)] * 5)
        np.testing.assert_allclose(forces[:, 2], [0.1, 0.2, 0.3, 0.4, 0.4], rtol=1e-15)
        assert [TickFlag.RAMPING in each for each in flags] == [True] * 3 + [False] * 2

    def test_swapped_scene_fades_in_from_the_current_force(self):
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
    @pytest.mark.parametrize("delay", [0, 1, 3, MOST_DELAY])
    def test_delayed_forces_are_cleared_by_stop(self, delay: int):
        """A force that would have arrived after the stop does no work."""
        settings, memory = Safety(passivity="strict", delay_ticks=delay, **AT_ONCE).arrays(SPEC, 0.0)
        for _ in range(2 * MOST_DELAY + 2):
            guard(settings, memory, 0.001, *[0.0] * 6, 1.0, 1.0, 1.0)
        stopped(memory, settings)
        for i in range(MOST_DELAY + 1):
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

    def test_first_position_after_stale_ticks_gives_zero_force(self):
        settings, memory = Safety(stale_s=0.005, **BARE).arrays(SPEC, 0.0)
        push = (*[0.0] * 6, 0.0, 0.0, 0.4)
        guard(settings, memory, 0.001, *push)
        assert guard(settings, memory, 0.006, *push) == (0.0, 0.0, 0.0, TickFlag.STALE)
        assert guard(settings, memory, 0.001, *push)[2] == 0.4

    def test_position_at_the_age_limit_is_not_stale(self):
        settings, memory = Safety(stale_s=0.0625, max_step_n=10, **BARE).arrays(SPEC, 0.0)
        push = (*[0.0] * 6, 0.1, 0.2, 0.4)
        for period_s in (0.001, 0.0625):
            assert guard(settings, memory, period_s, *push)[:3] == (0.1, 0.2, 0.4)
        for _ in range(2):
            assert wait(settings, memory, 0.03125) == (0.1, 0.2, 0.4, 0)
        assert wait(settings, memory, 2**-20)[3] == TickFlag.STALE

    def test_time_of_waits_is_added_to_the_next_tick(self):
        """A quarter of a millisecond allows an eighth of a newton, and after three such waits half of one."""
        settings, memory = Safety(max_step_n=0.5, **BARE).arrays(SPEC, 0.0)
        push = (*[0.0] * 6, 5.0, 0.0, 0.0)
        assert guard(settings, memory, 0.00025, *push)[0] == 0.125
        for _ in range(3):
            wait(settings, memory, 0.00025)
        assert guard(settings, memory, 0.00025, *push)[0] == 0.625
        assert guard(settings, memory, 0.00025, *push)[0] == 0.75

    def test_waits_and_tick_beyond_the_age_limit_are_stale(self):
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

    def test_force_of_soft_law_stays(self):
        forces, flags, _ = ticks(Safety(**BARE), [(0.0, 0.0, 0.4)] * 50, stiffness=2399.0)
        assert (forces[:, 2] == 0.4).all()
        assert TickFlag.STIFFNESS_LIMITED not in flags[-1]

    @pytest.mark.parametrize("delay", [0, 1, 2])
    def test_stiffness_limit_follows_the_measured_period(self, delay: int):
        safety = Safety(delay_ticks=delay, **BARE)
        forces, _, _ = ticks(safety, [(0.0, 0.0, 0.4)] * 2500, stiffness=2000.0, period_s=0.004)
        assert forces[-1, 2] == pytest.approx(0.4 * 0.8 * 2 * 1.5 / 0.004 / (1 + 2 * delay) / 2000, rel=1e-6)

    def test_jitter_counts_by_the_mean_square_of_the_period(self):
        settings, memory = Safety(**BARE).arrays(SPEC, 3000.0)
        left = [guard(settings, memory, 0.0005 if i % 2 else 0.0015, *[0.0] * 6, 0.0, 0.0, 0.4)[2] for i in range(4000)]
        # E[T^2] / E[T] is 1.25 ms; the share stays where the clock was worst
        assert left[-1] == pytest.approx(0.4 * 0.8 * 3 / 0.00125 / 3000, rel=5e-3)
        assert np.ptp(left[-500:]) < 1e-12

    def test_gain_rises_slowly_and_falls_quickly(self):
        settings, memory = Safety(**BARE).arrays(SPEC, 2000.0)
        push = (*[0.0] * 6, 0.0, 0.0, 0.4)
        slow = np.array([guard(settings, memory, 0.004, *push)[2] for _ in range(1000)]) / 0.4
        quick = np.array([guard(settings, memory, 0.001, *push)[2] for _ in range(3000)]) / 0.4
        assert slow[-1] == pytest.approx(0.3, rel=1e-3)
        assert np.diff(slow).min() >= -0.004 / 0.05 - 1e-12
        assert 0 < np.diff(quick).max() <= 0.001 / 1.0 + 1e-12
        assert quick[-1] == 1.0

    def test_force_without_contact_has_no_stiffness_flag(self):
        safety = Safety(coupling=Coupling(stiffness_n_per_m=4800, damping_n_s_per_m=0), max_step_n=10, **BARE)
        settings, memory = safety.arrays(SPEC, 0.0)
        couple(settings, memory, 0.001, *[0.0] * 6)
        away = (-0.001, *[0.0] * 5)
        assert guard(settings, memory, 0.001, *away, 0.0, 0.0, 0.0) == pytest.approx((4.8, 0.0, 0.0, 0))
        assert (
            guard(settings, memory, 0.001, *away, 0.0, 0.0, 1e-9)[3] == TickFlag.TOUCHING | TickFlag.STIFFNESS_LIMITED
        )

    def test_gain_after_one_long_tick_is_exact(self):
        """The mean of T is 1 + 2 / 128 ms, that of its square 1 + 8 / 128 ms^2: 2294 N/m are stable, of 2390."""
        settings, memory = Safety(**BARE).arrays(SPEC, 2390.0)
        held = 2.4 * (0.001 + 0.002 / 128) / (1e-6 + 8e-6 / 128)
        assert guard(settings, memory, 0.003, *[0.0] * 6, 0.0, 0.0, 0.4)[2] == pytest.approx(0.4 * held / 2390)

    def test_gain_falls_over_50_ms(self):
        settings, memory = Safety(**BARE).arrays(SPEC, 2000.0)
        assert guard(settings, memory, 0.019, *[0.0] * 6, 0.0, 0.0, 0.4)[2] == pytest.approx(0.4 * (1 - 0.019 / 0.05))

    def test_encoder_limit_does_not_depend_on_the_period(self):
        """2 f / Delta is 2000 N/m, of which 1600 may be used."""
        forces, _, _ = ticks(Safety(friction_n=0.03, **BARE), [(0.0, 0.0, 0.4)] * 500, stiffness=2000.0)
        np.testing.assert_allclose(forces[:, 2], 0.4 * 1600 / 2000)


class TestPassivity:
    def energies(self, moves, **options):
        """Yield the energy after each (x, law's force along x), with velocity zero, so that nothing is damped."""
        settings, memory = Safety(**AT_ONCE, **options).arrays(SPEC, 0.0)
        for x, fx in moves:
            guard(settings, memory, 0.001, x, 0.0, 0.0, 0.0, 0.0, 0.0, fx, 0.0, 0.0)
            yield memory[ENERGY_J]

    @pytest.mark.parametrize("delay", [0, 1, 3])
    def test_work_of_held_force_is_exact(self, delay: int):
        random = np.random.default_rng(0)
        x, fx = np.cumsum(random.uniform(-1e-3, 1e-3, 50)), random.uniform(0.1, 1, 50)
        held = np.concatenate([np.zeros(1 + delay), fx])[:50]
        work = np.cumsum(held * np.diff(x, prepend=x[0]))
        found = list(self.energies(zip(x, fx, strict=True), passivity="strict", delay_ticks=delay))
        np.testing.assert_allclose(found, -work, atol=1e-15)

    @pytest.mark.parametrize("delay", [0, 2])
    def test_work_counts_along_every_axis(self, delay: int):
        random = np.random.default_rng(1)
        places, forces = np.cumsum(random.uniform(-1e-3, 1e-3, (40, 3)), axis=0), random.uniform(0.1, 1, (40, 3))
        held = np.concatenate([np.zeros((1 + delay, 3)), forces])[:40]
        work = np.cumsum(np.sum(held * np.diff(places, axis=0, prepend=places[:1]), axis=1))
        settings, memory = Safety(passivity="strict", delay_ticks=delay, **AT_ONCE).arrays(SPEC, 0.0)
        found = []
        for place, force in zip(places, forces, strict=True):
            guard(settings, memory, 0.001, *place, 0.0, 0.0, 0.0, *force)
            found.append(memory[ENERGY_J])
        np.testing.assert_allclose(found, -work, atol=1e-15)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_jump_along_any_axis_is_not_work(self, axis: int):
        settings, memory = Safety(passivity="strict", **AT_ONCE).arrays(SPEC, 0.0)
        for way, found in ((0.0, 0.0), (0.009, -0.0045), (0.0201, -0.0045)):
            place = way * np.eye(3)[axis]
            guard(settings, memory, 0.001, *place, 0.0, 0.0, 0.0, 0.5, 0.5, 0.5)
            assert memory[ENERGY_J] == pytest.approx(found)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_energy_credit_lasts_while_the_force_falls(self, axis: int):
        """0.5 N over 1 mm; then the law's force ends, and the sent force is zero one tick later."""
        settings, memory = Safety(passivity="strict", ramp_s=0, max_step_n=0.5).arrays(SPEC, 0.0)
        along, found = np.eye(3)[axis], []
        for way, push in ((0.0, 1.0), (-0.001, 0.0), (-0.001, 0.0)):
            guard(settings, memory, 0.001, *(way * along), 0.0, 0.0, 0.0, *(push * along))
            found.append(memory[ENERGY_J])
        assert found == pytest.approx([0.0, 5e-4, 0.0])

    @pytest.mark.parametrize("axis", [0, 1, 2])
    @pytest.mark.parametrize(
        ("passivity", "gained_j", "left_n"),
        [("strict", 0.0, 0.0), ("strict", 1e-5, 0.1), ("strict", 2.1e-5, 0.2), ("coupled", 0.0, 0.12)],
    )
    def test_brake_predicts_the_energy_of_this_tick(self, axis: int, passivity: str, gained_j: float, left_n: float):
        """0.2 N at 0.1 m/s give 20 uJ in a tick; of that the handle's damping of 1.2 N s/m takes 12 uJ."""
        settings, memory = Safety(passivity=passivity, **AT_ONCE).arrays(SPEC, 0.0)
        memory[ENERGY_J] = gained_j
        along = np.eye(3)[axis]
        *force, flags = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, *(0.1 * along), *(0.2 * along))
        assert force == pytest.approx(left_n * along, abs=1e-15)
        assert bool(flags & TickFlag.DAMPED) == (left_n < 0.2)

    def test_slow_hand_is_damped(self):
        settings, memory = Safety(passivity="strict", **AT_ONCE).arrays(SPEC, 0.0)
        memory[ENERGY_J] = -1e-3
        fx, _, fz, _ = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, 2e-5, 0.0, 0.0, 0.0, 0.0, 0.2)
        assert (fx, fz) == pytest.approx((-7.5 * 2e-5, 0.2))

    def test_damped_force_is_at_most_the_maximum(self):
        settings, memory = Safety(passivity="strict", **AT_ONCE).arrays(SPEC, 0.0)
        memory[ENERGY_J] = -8e-3
        left = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 8.0)
        assert left[:3] == pytest.approx(np.array([0.0, -7.5, 8.0]) * 8 / math.hypot(7.5, 8))

    def test_handle_damping_counts_up_to_the_margin(self):
        *_, energy = self.energies([(0.0, 1e-9), (0.002, 1e-9)], stiffness_margin=0.5)
        assert energy == pytest.approx(0.5 * 1.5 * 2.0**2 * 0.001, rel=1e-6)

    def test_energy_credit_ends_in_free_air_but_debt_stays(self):
        gained = list(self.energies([(0.0, 1.0), (-0.001, 0.0), (-0.001, 0.0)], passivity="strict"))
        assert gained == pytest.approx([0.0, 1e-3, 0.0])
        owed = list(self.energies([(0.0, 1.0), (0.001, 0.0), (0.001, 0.0)], passivity="strict"))
        assert owed == pytest.approx([0.0, -1e-3, -1e-3])

    def test_energy_debt_is_at_most_the_greatest_force_over_a_millimetre(self):
        moves = [(0.005 * i, 8.0) for i in range(10)]
        assert list(self.energies(moves, passivity="strict"))[-1] == pytest.approx(-0.008)

    def test_jump_of_the_sensor_is_not_work(self):
        assert list(self.energies([(0.0, 1.0), (0.011, 1.0)], passivity="strict")) == [0.0, 0.0]

    @pytest.mark.parametrize(("owed_j", "damping"), [(1e-6, 0.1), (1e-5, 1.0), (1e-3, 7.5)])
    def test_brake_follows_the_formula_up_to_five_times_the_device_damping(self, owed_j: float, damping: float):
        settings, memory = Safety(passivity="strict", **AT_ONCE).arrays(SPEC, 0.0)
        memory[ENERGY_J] = -owed_j
        fx, fy, fz, flags = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.2)
        assert (fx, fy, fz) == pytest.approx((-0.1 * damping, 0.0, 0.2))
        assert flags == TickFlag.TOUCHING | TickFlag.DAMPED

    @pytest.mark.parametrize("speed", [0.0, 1e-6, 11.0, 1e200])
    def test_noise_and_impossible_speeds_are_not_damped(self, speed: float):
        settings, memory = Safety(passivity="strict", **AT_ONCE).arrays(SPEC, 0.0)
        memory[ENERGY_J] = -1e-3
        assert guard(settings, memory, 0.001, 0.0, 0.0, 0.0, speed, 0.0, 0.0, 0.0, 0.0, 0.2)[:3] == (0.0, 0.0, 0.2)


class TestCoupling:
    def test_coupling_absent_passes_the_device_state(self):
        settings, memory = Safety().arrays(SPEC, 500.0)
        state = (0.001, 0.002, -0.003, 0.1, -0.2, 0.3)
        assert couple(settings, memory, 0.001, *state) == state

    def test_coupling_and_law_are_springs_in_series(self):
        safety = Safety(coupling=Coupling(stiffness_n_per_m=1000, damping_n_s_per_m=0.4), **BARE)
        settings, memory = safety.arrays(SPEC, 500.0)
        device = (0.0, 0.0, -0.003, 0.0, 0.0, 0.0)
        for _ in range(500):
            tool = couple(settings, memory, 0.001, *device)
            left = guard(settings, memory, 0.001, *device, 0.0, 0.0, -500.0 * tool[2])
        assert left[2] == pytest.approx(0.003 / (1 / 1000 + 1 / 500), rel=1e-9)
        assert tool[2] == pytest.approx(-left[2] / 500, rel=1e-9)

    def test_tool_moves_by_backward_euler_along_every_axis(self):
        """m (v' - v) / T = F + k (p - x') + b (u - v'), x' = x + T v', T with the waits before, m = K T^2 / 2."""
        law, stiffness, damping, random = 500.0, 1000.0, 0.4, np.random.default_rng(2)
        coupling = Coupling(stiffness_n_per_m=stiffness, damping_n_s_per_m=damping)
        settings, memory = Safety(coupling=coupling, max_step_n=10, **BARE).arrays(SPEC, law)
        place, speed = random.uniform(-1e-3, 1e-3, 3), random.uniform(-0.1, 0.1, 3)
        assert couple(settings, memory, 0.001, *place, *speed) == (*place, *speed)
        tool, rate = place, speed
        for waits in (0, 2, 0, 1):
            push = random.uniform(0.1, 0.3, 3)
            left = guard(settings, memory, 0.001, *place, *speed, *push)[:3]
            np.testing.assert_allclose(left, stiffness * (tool - place) + damping * (rate - speed), atol=1e-12)
            place, speed = place + random.uniform(-1e-4, 1e-4, 3), random.uniform(-0.1, 0.1, 3)
            for _ in range(waits):
                wait(settings, memory, 0.001)
            period_s = 0.001 * (1 + waits)
            mass = law * period_s**2 / 2
            pull = push + stiffness * (place - tool) + damping * speed
            rate = (mass * rate + period_s * pull) / (mass + period_s * damping + period_s**2 * stiffness)
            tool = tool + period_s * rate
            np.testing.assert_allclose(couple(settings, memory, 0.001, *place, *speed), (*tool, *rate), rtol=1e-9)

    def test_python_law_gets_the_tool_state(self):
        asked: list[HapticState] = []

        class Asked(PlainTouch):
            def force(self, state: HapticState) -> Force:
                asked.append(state)
                return Force(0.0, 0.0, 1.0)

        (settings, memory), (_, twin) = (Safety(coupling="auto", **BARE).arrays(SPEC, 0.0) for _ in range(2))
        allowed = guard_touch(Asked(), settings, memory)
        for x in (0.0, 0.002):
            state = HapticState((x, 0.0, -0.001), (0.1, 0.0, 0.0), x, 3)
            tool = couple(settings, twin, 0.002, *state.position_m, *state.velocity_m_per_s)
            force, flags = allowed(state, 0.002)
            assert asked[-1] == (tool[:3], tool[3:], x, 3)
            assert (*force, flags) == guard(
                settings, twin, 0.002, *state.position_m, *state.velocity_m_per_s, 0.0, 0.0, 1.0
            )
        assert asked[-1].position_m[0] != 0.002
        assert allowed(state, 0.5) == ((0.0, 0.0, 0.0), TickFlag.STALE)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_tool_not_finite_returns_to_the_device(self, axis: int):
        settings, memory = Safety(coupling="auto", **BARE).arrays(SPEC, 500.0)
        far = 1e308 * np.eye(3)[axis]
        for place in (np.zeros(3), far, -far, np.zeros(3)):
            assert couple(settings, memory, 0.001, *place, 0.0, 0.0, 0.0) == (*place, 0.0, 0.0, 0.0)
            left = guard(settings, memory, 0.001, *place, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            assert left == (0.0, 0.0, 0.0, 0)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_tool_force_that_overflows_is_zero(self, axis: int):
        """A heavy tool keeps its velocity while the device's is opposite: their difference overflows."""
        safety = Safety(coupling=Coupling(stiffness_n_per_m=1000, damping_n_s_per_m=1.5), **BARE)
        settings, memory = safety.arrays(SPEC, 1e5)
        for speed in (-1e308, 1e308):
            velocity = speed * np.eye(3)[axis]
            couple(settings, memory, 0.001, 0.0, 0.0, 0.0, *velocity)
            left = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, *velocity, 0.0, 0.0, 0.0)
            assert left == (0.0, 0.0, 0.0, 0)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    @pytest.mark.parametrize(("way_m", "follows"), [(0.016, True), (0.021, False), (-1.0, False)])
    def test_tool_follows_a_device_that_jumps(self, axis: int, way_m: float, follows: bool):
        """Such as a released pointer: 8 N at 1000 N/m is a leash of 8 mm, and no hand moves 10 mm in a tick."""
        safety = Safety(coupling=Coupling(stiffness_n_per_m=1000, damping_n_s_per_m=0.4), **BARE)
        settings, memory = safety.arrays(SPEC, 500.0)
        couple(settings, memory, 0.001, *[0.0] * 6)
        place = way_m * np.eye(3)[axis]
        tool = couple(settings, memory, 0.001, *place, 0.0, 0.0, 0.0)
        assert (tool[axis] != way_m) == follows
        left = guard(settings, memory, 0.001, *place, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        assert (left[axis] != 0.0) == follows

    def test_tool_stays_within_its_leash(self):
        safety = Safety(coupling=Coupling(stiffness_n_per_m=1000, damping_n_s_per_m=0.4), **BARE)
        settings, memory = safety.arrays(SPEC, 500.0)
        for _ in range(500):
            tool = couple(settings, memory, 0.001, *[0.0] * 6)
            guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 1e6)
        assert tool[2] == pytest.approx(8.0 / 1000)


HOSTILE = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True),
    st.sampled_from([0.0, -0.0, 5e-324, -5e-324, 1e308, -1e308, 1e-3, NAN, math.inf]),
    st.floats(-0.1, 0.1),
    st.floats(-20, 20),
)
PERIODS = st.one_of(st.sampled_from([0.001, 0.0, -1.0, 1e-9, 0.5, 1e308, NAN]), st.floats(1e-4, 5e-3))
OPTIONS = st.builds(
    Safety,
    ramp_s=st.sampled_from([0, 0.01]),
    passivity=st.sampled_from(["off", "coupled", "strict"]),
    coupling=st.sampled_from([None, "auto"]),
    delay_ticks=st.integers(0, 8),
    max_step_n=st.sampled_from([0.01, 0.5, 10]),
)


@given(
    safety=OPTIONS,
    stiffness=st.sampled_from([0.0, 800.0, 1e5]),
    states=st.lists(st.tuples(PERIODS, *[HOSTILE] * 9), min_size=1, max_size=40),
    waits=st.integers(0, 3),
)
@example(
    safety=Safety(coupling="auto", ramp_s=0),
    stiffness=0.0,
    states=[(0.001, *[0.0] * 6, 1.0, 0.0, 0.0), (0.001, 0.0, 0.0, 0.0, 1e308, -1e308, 0.0, 1e308, -1e308, 0.0)] * 3,
    waits=0,
)
def test_force_of_any_input_keeps_the_limits(
    safety: Safety, stiffness: float, states: list[tuple[float, ...]], waits: int
):
    settings, memory = safety.arrays(SPEC, stiffness)
    last = np.zeros(3)
    for period_s, *rest in states:
        for _ in range(waits):
            last = _kept(last, wait(settings, memory, period_s / 4), safety.max_step_n)
        tool = couple(settings, memory, period_s, *rest[:6])
        law = rest[6:] if np.isfinite(tool).all() else [0.0] * 3
        last = _kept(last, guard(settings, memory, period_s, *rest[:6], *law), safety.max_step_n)


def _kept(last: np.ndarray, left: tuple[float, float, float, int], step_n: float) -> np.ndarray:
    """Return the force, after checking it against every limit."""
    force, flags = np.array(left[:3]), TickFlag(left[3])
    assert np.isfinite(force).all()
    assert np.linalg.norm(force) <= SPEC.max_force_n * (1 + 1e-12)
    if flags & (TickFlag.NOT_FINITE | TickFlag.STALE):
        assert not force.any()
    else:
        assert np.linalg.norm(force - last) <= step_n * (1 + 1e-12)
    return force


def test_limits_that_act_are_counted():
    settings, memory = Safety(**BARE).arrays(SPEC, 0.0)
    for force in ([0.3, 0, 0], [50, 0, 0], [50, 0, 0], [0, 0, 0], [NAN, 0, 0], [0, 0, 0]):
        guard(settings, memory, 0.001, *[0.0] * 6, *map(float, force))
    assert counts(memory) == {
        TickFlag.TOUCHING: 3, TickFlag.FORCE_LIMITED: 2, TickFlag.SLEW_LIMITED: 3, TickFlag.NOT_FINITE: 1,
    }  # fmt: skip
