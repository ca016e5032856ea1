"""A law in plain Python writes `force`; the way along a path is made of it."""

import math

import numpy as np
import pytest

from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.errors import GeometryError
from tangible_core.plugins.interfaces import PlainTouch


class Tape(PlainTouch):
    """Writes down what it is asked, and pushes by how often that was."""

    def __init__(self) -> None:
        self.asked: list[HapticState] = []

    def force(self, state: HapticState) -> Force:
        self.asked.append(state)
        return Force(1.0, 2.0, float(len(self.asked)))


def test_it_is_asked_position_by_position_in_order():
    tape = Tape()
    forces = tape.path(np.array([[0, 0, 0], [0.001, 0, 0], [0.001, 0.004, -0.002]]), 0.002)
    assert forces.tolist() == [[1, 2, 1], [1, 2, 2], [1, 2, 3]]
    assert [state.position_m for state in tape.asked] == [(0, 0, 0), (0.001, 0, 0), (0.001, 0.004, -0.002)]
    assert [state.velocity_m_per_s for state in tape.asked] == [(0, 0, 0), (0.5, 0, 0), (0, 2, -1)]
    assert [state.time_s for state in tape.asked] == [0, 0.002, 0.004]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1.7e308])
def test_a_velocity_that_is_not_finite_is_none(bad: float):
    tape = Tape()
    tape.path(np.array([[-bad, 0.0, 0.0], [bad, 0.0, 0.0], [0.0, 0.0, 0.0], [0.001, 0.0, 0.0]]))
    assert [state.velocity_m_per_s for state in tape.asked] == [(0, 0, 0)] * 3 + [(1.0, 0, 0)]


def test_no_positions_give_no_forces():
    assert Tape().path(np.empty((0, 3))).shape == (0, 3)


def test_the_velocities_are_those_of_a_compiled_law():
    """To the last bit, as both are the step over the period."""
    from tangible_core.compiled.kernels import step_velocity

    tape, path = Tape(), np.random.default_rng(0).uniform(-0.05, 0.05, (200, 3))
    path[50] = math.nan
    tape.path(path, 0.0007)
    assert [state.velocity_m_per_s for state in tape.asked] == [step_velocity(path, 0.0007, i) for i in range(200)]


@pytest.mark.usefixtures("unchecked_shapes")
@pytest.mark.parametrize(
    ("positions", "period_s", "says"),
    [
        (np.zeros((4, 2)), 0.001, "a path is"),
        (np.zeros(3), 0.001, "a path is"),
        (np.zeros((4, 3)), 0.0, "period_s: is 0.0; it must be positive and finite"),
        (np.zeros((4, 3)), math.nan, "period_s: is nan; it must"),
        (np.zeros((4, 3)), math.inf, "period_s: is inf; it must"),
    ],
)
def test_what_is_no_path(positions: np.ndarray, period_s: float, says: str):
    with pytest.raises(GeometryError, match=says):
        Tape().path(positions, period_s)


def test_a_law_is_force_alone():
    class Nothing(PlainTouch):
        pass

    with pytest.raises(TypeError, match="force"):
        Nothing()

    class Free(PlainTouch):
        def force(self, state: HapticState) -> Force:
            return NO_FORCE

    assert Free().path(np.zeros((2, 3))).tolist() == [[0, 0, 0], [0, 0, 0]]
