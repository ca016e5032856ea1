"""The passivity observer and controller: without them a loop gives a hand energy, and shakes it."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from tangible_core.data import DeviceSpec, TickFlag
from tangible_core.servo.guard.guard import guard
from tangible_core.servo.guard.layout import ENERGY_J
from tangible_core.servo.guard.safety import Safety

DAMPING = 1.5
SPEC = DeviceSpec(8.0, 3000.0, DAMPING, (0.08, 0.08, 0.08), 3e-5)
STRICT = Safety(passivity="strict", ramp_s=0, max_step_n=10)
COUPLED = Safety(passivity="coupled", ramp_s=0, max_step_n=10, stiffness_margin=0.5)
AT_ONCE = {"ramp_s": 0, "max_step_n": 10}
AXES = pytest.mark.parametrize("axis", range(3))
REST = (0.0, 0.0, 0.0)


def along(axis: int, size: float) -> tuple[float, float, float]:
    x, y, z = np.eye(3)[axis] * size
    return x, y, z


def tick(arrays, place: Sequence[float], velocity: Sequence[float], force: Sequence[float], period_s: float = 0.001):
    settings, memory = arrays
    fx, fy, fz, flags = guard(settings, memory, period_s, *place, *velocity, *force)
    return np.array([fx, fy, fz]), TickFlag(flags)


class TestObserver:
    def test_energy_begins_at_the_first_position_and_its_debt_is_bounded(self):
        arrays = COUPLED.arrays(SPEC, 0.0)
        tick(arrays, (0.002, 0.002, 0.002), REST, (0.0, 0.0, 1e-12))
        assert arrays[1][ENERGY_J] == 0.0
        arrays = Safety(passivity="strict", ramp_s=0, max_step_n=10, max_force_n=2).arrays(SPEC, 0.0)
        for step in range(10):
            tick(arrays, (0.005 * step, 0.0, 0.0), REST, (8.0, 0.0, 0.0))
        assert arrays[1][ENERGY_J] == pytest.approx(-2.0 * 0.001)

    @pytest.mark.parametrize("period_s", [0.0005, 0.002])
    def test_damping_credit_scales_with_the_period(self, period_s: float):
        arrays = COUPLED.arrays(SPEC, 0.0)
        tick(arrays, REST, REST, (0.0, 0.0, 1e-12), period_s)
        tick(arrays, (0.001, 0.001, 0.001), REST, (0.0, 0.0, 1e-12), period_s)
        assert arrays[1][ENERGY_J] == pytest.approx(0.5 * DAMPING * 3e-6 / period_s)


class TestController:
    @pytest.mark.parametrize(("safety", "credit"), [(STRICT, 0.0), (COUPLED, 0.5 * DAMPING)])
    @pytest.mark.parametrize("velocity", [(0.1, 0.2, 0.05), (0.0, -0.1, 0.2), (0.3, 0.0, 0.0), (0.0, 0.0, 0.3)])
    @pytest.mark.parametrize("energy_j", [0.0, -2e-5, 2e-5])
    @pytest.mark.parametrize("period_s", [0.0005, 0.001, 0.002])
    def test_energy_of_this_tick_is_damped_in_advance(
        self, safety: Safety, credit: float, velocity: tuple[float, float, float], energy_j: float, period_s: float
    ):
        arrays, force, v = safety.arrays(SPEC, 0.0), np.array([0.3, -0.2, 0.25]), np.array(velocity)
        arrays[1][ENERGY_J] = energy_j
        gives_j = (force @ v - credit * v @ v) * period_s - energy_j
        brake = np.clip(gives_j / (period_s * v @ v), 0, 5 * DAMPING)
        left, flags = tick(arrays, REST, velocity, force.tolist(), period_s)
        np.testing.assert_allclose(left, force - brake * v, atol=1e-12)
        assert (TickFlag.DAMPED in flags) == (brake > 0)

    @AXES
    def test_released_force_is_damped_while_it_acts(self, axis: int):
        arrays = STRICT.arrays(SPEC, 0.0)
        tick(arrays, REST, REST, along(axis, 1.0))
        arrays[1][ENERGY_J] = -1e-3
        left, flags = tick(arrays, REST, (0.1, 0.0, 0.0), REST)
        np.testing.assert_allclose(left, (-0.1 * 5 * DAMPING, 0.0, 0.0))
        assert flags == TickFlag.DAMPED

    def test_hand_in_free_air_or_without_passivity_is_not_damped(self):
        arrays = Safety(passivity="off", ramp_s=0, max_step_n=10).arrays(SPEC, 0.0)
        arrays[1][ENERGY_J] = -1e-3
        left, flags = tick(arrays, REST, (0.1, 0.1, 0.1), (0.0, 0.0, 0.2))
        assert left.tolist() == [0.0, 0.0, 0.2]
        assert flags == TickFlag.TOUCHING
        arrays = STRICT.arrays(SPEC, 0.0)
        arrays[1][ENERGY_J] = -1e-3
        left, flags = tick(arrays, REST, (0.1, 0.0, 0.0), REST)
        assert not left.any()
        assert not flags


class TestPassivity:
    def energies(self, moves, **options):
        """Yield the energy after each (x, law's force along x), with velocity zero, so that nothing is damped."""
        settings, memory = Safety(**AT_ONCE, **options).arrays(SPEC, 0.0)
        for x, fx in moves:
            guard(settings, memory, 0.001, x, 0.0, 0.0, 0.0, 0.0, 0.0, fx, 0.0, 0.0)
            yield memory[ENERGY_J]

    @pytest.mark.parametrize("delay", [0, 1, 3])
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

    def test_slow_hand_is_damped_up_to_the_maximum(self):
        settings, memory = Safety(passivity="strict", **AT_ONCE).arrays(SPEC, 0.0)
        memory[ENERGY_J] = -1e-3
        fx, _, fz, _ = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, 2e-5, 0.0, 0.0, 0.0, 0.0, 0.2)
        assert (fx, fz) == pytest.approx((-7.5 * 2e-5, 0.2))
        settings, memory = Safety(passivity="strict", **AT_ONCE).arrays(SPEC, 0.0)
        memory[ENERGY_J] = -8e-3
        left = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 8.0)
        assert left[:3] == pytest.approx(np.array([0.0, -7.5, 8.0]) * 8 / math.hypot(7.5, 8))

    def test_energy_credit_ends_in_free_air_but_debt_stays(self):
        gained = list(self.energies([(0.0, 1.0), (-0.001, 0.0), (-0.001, 0.0)], passivity="strict"))
        assert gained == pytest.approx([0.0, 1e-3, 0.0])
        owed = list(self.energies([(0.0, 1.0), (0.001, 0.0), (0.001, 0.0)], passivity="strict"))
        assert owed == pytest.approx([0.0, -1e-3, -1e-3])

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
