"""Measures of force laws along strokes and under a handle, against laws that have them by their making."""

import math

import numpy as np
import pytest

from simulated_handle import exact_stiffness_limit
from tangible_bench.metrics.stability import HANDLE, Handle, Law, force_steps, loop_works, proxy_lag, stiffness_limit
from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.servo.guard.safety import stiffness_limit_n_per_m

UP = np.array((0.0, 0.0, 1.0))
RANDOM = np.random.default_rng(2)


def rows(*vectors: tuple[float, ...]) -> np.ndarray:
    return np.array(vectors, np.float64)


def test_lag_is_that_of_a_delay_and_steps_of_forces_the_largest():
    """A proxy that is 4 ticks late at 50 mm/s is 0.2 mm behind in every direction of the hand."""
    turn = np.linspace(0, 2 * np.pi, 4001)
    hand = 0.05 * 4 / (2 * np.pi) * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(4001)])
    nearest = hand + 0.001 * UP
    late = np.roll(nearest, 4, axis=0)
    assert proxy_lag(hand, late, nearest) == pytest.approx(0.0002, rel=0.01)
    assert proxy_lag(hand, nearest, nearest) == 0
    there = np.vstack([hand, hand[::-1]])
    assert proxy_lag(there, there + UP + (0.0003, 0, 0), there + UP) == pytest.approx(0, abs=1e-12), "aside, both ways"
    hand = rows((0, 0, 0), (1, 0, 0), (1, 1, 0))
    nearest = hand + rows((0, 0, 0), (0, 0, 1), (0, 0, 0))
    assert proxy_lag(hand, nearest - (0.5, 0, 0), nearest) == pytest.approx(0.5 / math.sqrt(2))
    hand = rows((0, 0, 1), (1, 0, 1), (2, 0, 1), (2, 0, 1), (2, 0, 1))
    nearest = hand + rows((0, 0, 0), (0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1))
    proxy = nearest - rows((9, 0, 0), (0.5, 0, 0), (0.5, 0, 0), (0.5, 0, 0), (9, 0, 0))
    assert proxy_lag(hand, proxy, nearest) == pytest.approx(0.5)
    force = np.zeros((1001, 3))
    force[:20, 0] = np.arange(20) / 1000  # 19 steps of a thousandth, one of 5, and 980 of none
    force[20:] = (0.019, 3, 4)
    assert force_steps(force)["step_n"] == pytest.approx(5)
    assert force_steps(force)["step_p99_n"] == pytest.approx(0.001, rel=1e-9)
    assert force_steps(np.repeat(rows((1, 2, 3)), 4, axis=0)) == {"step_n": 0, "step_p99_n": 0}


def loops(count: int = 3, ticks: int = 500) -> tuple[np.ndarray, np.ndarray]:
    """Make paths in and out at different places, with masks of the ticks over the level z = 0."""
    t = np.arange(count * ticks + 1) / ticks
    z = 0.001 * np.cos(2 * np.pi * t)
    return np.column_stack([0.02 * np.sin(t), 0.01 * t, z]), z > 0.0009


def test_work_of_springs_and_known_laws_is_exact():
    """Pushed along x by 2 N: 2 N times the way of each loop; friction is the negative of that."""
    hand, free = loops()
    push = np.tile((2.0, 0.0, 0.0), (len(hand), 1))
    ways = loop_works(push, hand, free) / 2
    ends = [np.flatnonzero(~free & (np.floor(np.arange(len(hand)) / 500) == loop))[[0, -1]] for loop in range(3)]
    np.testing.assert_allclose(ways, [hand[last + 1, 0] - hand[first - 1, 0] for first, last in ends], atol=1e-12)
    np.testing.assert_allclose(loop_works(-push, hand, free), -2 * ways)
    hand, free = loops()
    works = loop_works(-800 * hand, hand, np.ones(len(hand), np.bool_))
    assert works.size == 0  # free everywhere: there is no loop
    assert loop_works(hand, hand, np.zeros(len(hand), np.bool_)).size == 0  # nor where it is free nowhere
    force = 800 * np.maximum(-hand[:, 2:], 0) * UP
    works = loop_works(force, hand, free)
    assert works.size == 3
    assert np.abs(works).max() < 1e-9 * 3 + 800 * 0.0000126**2  # the tick that crosses the surface


@pytest.mark.parametrize("count", [0, 3])
def test_paths_without_force_give_nan(count: int):
    nothing = np.zeros((count, 3))
    assert math.isnan(proxy_lag(nothing, nothing, nothing))
    assert math.isnan(force_steps(nothing[:1])["step_n"])
    assert loop_works(nothing, nothing, np.zeros(count, np.bool_)).size == 0


GROUND_M = 0.01


def spring(stiffness: float, damping: float = 0.0) -> Law:
    def law(state: HapticState) -> Force:
        depth = GROUND_M - state.position_m[2]
        return Force(0.0, 0.0, stiffness * depth - damping * state.velocity_m_per_s[2]) if depth > 0 else NO_FORCE

    return law


def literature_bound(delay_ticks: int) -> float:
    return stiffness_limit_n_per_m(HANDLE.damping_n_s_per_m, HANDLE.period_s, delay_ticks)


@pytest.mark.parametrize("delay", [0, 1, 2, 5])
@pytest.mark.parametrize("handle", [HANDLE, Handle(0.05, 1.0), Handle(0.3, 5.0, 0.002)])
def test_limit_is_where_eigenvalues_leave_the_unit_circle(delay: int, handle: Handle):
    exact = exact_stiffness_limit(handle, delay)
    assert stiffness_limit(spring, GROUND_M, delay, handle) == pytest.approx(exact, rel=0.005)


def test_limit_rises_with_the_damping_of_the_law_and_is_infinite_for_a_bounded_spring():
    found = stiffness_limit(lambda stiffness: spring(stiffness, 2.0), GROUND_M, 0)
    assert found == pytest.approx(exact_stiffness_limit(HANDLE, 0, 2.0), rel=0.005)
    assert found > 1.5 * literature_bound(0)
    assert stiffness_limit(lambda stiffness: spring(min(stiffness, 1000.0)), GROUND_M) == math.inf


@pytest.mark.parametrize(
    "law",
    [
        lambda stiffness: lambda state: NO_FORCE,
        lambda stiffness: lambda state: Force(0.0, 0.0, 3.0),
        lambda stiffness: lambda state: Force(stiffness, 0.0, 0.0),
        lambda stiffness: lambda state: Force(0.0, 0.0, -stiffness),
    ],
    ids=["no force", "constant", "lateral", "pull"],
)
def test_limit_of_a_law_without_a_spring_is_nan(law):
    assert math.isnan(stiffness_limit(law, GROUND_M))
