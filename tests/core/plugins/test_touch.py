"""Touches in plain Python. Otherwise a custom force law would be asked at wrong places, speeds or times."""

import math

import numpy as np
import pytest

from tangible_core.data import Force, HapticState
from tangible_core.errors import GeometryError
from tangible_core.plugins.interfaces import PlainTouch


class Tape(PlainTouch):
    """A touch that records its states, and pushes with the number of calls."""

    def __init__(self) -> None:
        self.states: list[HapticState] = []

    def force(self, state: HapticState) -> Force:
        self.states.append(state)
        return Force(1.0, 2.0, float(len(self.states)))


def test_path_calls_force_for_each_position_in_order():
    tape = Tape()
    forces = tape.path(np.array([[0, 0, 0], [0.001, 0, 0], [0.001, 0.004, -0.002]]), 0.002)
    assert forces.tolist() == [[1, 2, 1], [1, 2, 2], [1, 2, 3]]
    assert [state.position_m for state in tape.states] == [(0, 0, 0), (0.001, 0, 0), (0.001, 0.004, -0.002)]
    assert [state.velocity_m_per_s for state in tape.states] == [(0, 0, 0), (0.5, 0, 0), (0, 2, -1)]
    assert [state.time_s for state in tape.states] == [0, 0.002, 0.004]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1.7e308])
def test_path_velocity_not_finite_is_zero(bad: float):
    tape = Tape()
    tape.path(np.array([[-bad, 0.0, 0.0], [bad, 0.0, 0.0], [0.0, 0.0, 0.0], [0.001, 0.0, 0.0]]))
    assert [state.velocity_m_per_s for state in tape.states] == [(0, 0, 0)] * 3 + [(1.0, 0, 0)]


def test_path_without_positions_has_no_forces():
    assert Tape().path(np.empty((0, 3))).shape == (0, 3)


def test_path_velocities_equal_those_of_a_compiled_law():
    """The velocities are equal to the last bit, as both are the step over the period."""
    from tangible_core.compiled.kernels import step_velocity

    tape, path = Tape(), np.random.default_rng(0).uniform(-0.05, 0.05, (200, 3))
    path[50] = math.nan
    tape.path(path, 0.0007)
    assert [state.velocity_m_per_s for state in tape.states] == [step_velocity(path, 0.0007, i) for i in range(200)]


@pytest.mark.usefixtures("unchecked_shapes")
@pytest.mark.parametrize(
    ("positions", "period_s", "complaint"),
    [
        (np.zeros((4, 2)), 0.001, "a path is"),
        (np.zeros(3), 0.001, "a path is"),
        (np.zeros((4, 3)), 0.0, "period_s: is 0.0; it must be positive and finite"),
        (np.zeros((4, 3)), math.nan, "period_s: is nan; it must"),
        (np.zeros((4, 3)), math.inf, "period_s: is inf; it must"),
    ],
)
def test_path_of_a_wrong_shape_or_period_is_refused(positions: np.ndarray, period_s: float, complaint: str):
    with pytest.raises(GeometryError, match=complaint):
        Tape().path(positions, period_s)
