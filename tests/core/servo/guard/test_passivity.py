"""The passivity observer and controller, in every direction and at other periods than a millisecond."""

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
    @AXES
    def test_work_is_observed_along_each_axis(self, axis: int):
        """Two steps, as each starts at the stored place."""
        arrays = STRICT.arrays(SPEC, 0.0)
        for step in range(3):
            tick(arrays, along(axis, 0.001 * step), REST, (0.5, 0.25, 0.125))
        assert arrays[1][ENERGY_J] == pytest.approx(-2 * 0.001 * (0.5, 0.25, 0.125)[axis])

    @AXES
    def test_jump_along_any_axis_is_not_work(self, axis: int):
        arrays = STRICT.arrays(SPEC, 0.0)
        tick(arrays, REST, REST, (0.5, 0.25, 0.125))
        tick(arrays, along(axis, 0.011), REST, (0.5, 0.25, 0.125))
        assert arrays[1][ENERGY_J] == 0.0

    def test_energy_before_the_first_position_is_zero(self):
        arrays = COUPLED.arrays(SPEC, 0.0)
        tick(arrays, (0.002, 0.002, 0.002), REST, (0.0, 0.0, 1e-12))
        assert arrays[1][ENERGY_J] == 0.0

    def test_energy_debt_is_at_most_the_configured_force_over_a_millimetre(self):
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

    def test_damped_force_is_at_most_the_maximum(self):
        arrays = STRICT.arrays(SPEC, 0.0)
        arrays[1][ENERGY_J] = -1e-2
        left, flags = tick(arrays, REST, (-1.0, 0.0, 0.0), (7.9, 0.0, 0.0))
        assert left.tolist() == [8.0, 0.0, 0.0]
        assert TickFlag.DAMPED in flags

    @AXES
    def test_released_force_is_damped_while_it_acts(self, axis: int):
        arrays = STRICT.arrays(SPEC, 0.0)
        tick(arrays, REST, REST, along(axis, 1.0))
        arrays[1][ENERGY_J] = -1e-3
        left, flags = tick(arrays, REST, (0.1, 0.0, 0.0), REST)
        np.testing.assert_allclose(left, (-0.1 * 5 * DAMPING, 0.0, 0.0))
        assert flags == TickFlag.DAMPED

    def test_passivity_off_changes_no_force(self):
        arrays = Safety(passivity="off", ramp_s=0, max_step_n=10).arrays(SPEC, 0.0)
        arrays[1][ENERGY_J] = -1e-3
        left, flags = tick(arrays, REST, (0.1, 0.1, 0.1), (0.0, 0.0, 0.2))
        assert left.tolist() == [0.0, 0.0, 0.2]
        assert flags == TickFlag.TOUCHING

    def test_hand_in_free_air_is_not_damped(self):
        arrays = STRICT.arrays(SPEC, 0.0)
        arrays[1][ENERGY_J] = -1e-3
        left, flags = tick(arrays, REST, (0.1, 0.0, 0.0), REST)
        assert not left.any()
        assert not flags
