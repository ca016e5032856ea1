"""The stiffness limit of a sampled handle: against the bound of the literature and against eigenvalues."""

import math

import pytest

from simulated_handle import exact_stiffness_limit
from tangible_bench.metrics.stability import HANDLE, Handle, Law, stiffness_limit
from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.servo.guard.safety import stiffness_limit_n_per_m

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


def test_limit_rises_with_the_damping_of_the_law():
    found = stiffness_limit(lambda stiffness: spring(stiffness, 2.0), GROUND_M, 0)
    assert found == pytest.approx(exact_stiffness_limit(HANDLE, 0, 2.0), rel=0.005)
    assert found > 1.5 * literature_bound(0)


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


def test_limit_of_a_bounded_spring_is_infinite():
    assert stiffness_limit(lambda stiffness: spring(min(stiffness, 1000.0)), GROUND_M) == math.inf
