"""A simulated handle on springs: behind the guard every law comes to rest, where the bare law shakes the hand."""

from typing import Any

import numpy as np
import pytest

from simulated_handle import HandleLoop, comes_to_rest, exact_stiffness_limit, ride, stiffest_stable_n_per_m, wall
from tangible_bench.metrics.stability import Handle
from tangible_core.data import DeviceSpec
from tangible_core.servo.guard.safety import Safety, stiffness_limit_n_per_m

DAMPING = 2.0
SPEC = DeviceSpec(100.0, 1e7, DAMPING, (0.08, 0.08, 0.08), 1e-6)
FALLING = np.array([0.0, 0.0, 0.002, 0.0, 0.0, -0.05])
AT_ONCE = {"ramp_s": 0, "max_step_n": 10}
"""Options without ramp and slew limit, so that the force is the law's own."""
DELAYS = pytest.mark.parametrize("delay", [0, 1, 2])
PERIODS = pytest.mark.parametrize("period_s", [0.00025, 0.001, 0.004])


def handle(delay: int = 0, mass_kg: float = 0.1, period_s: float = 0.001, **more: float) -> HandleLoop:
    return HandleLoop(Handle(mass_kg, DAMPING, period_s), delay_ticks=delay, **more)


def limit(delay: int, period_s: float = 0.001) -> float:
    return stiffness_limit_n_per_m(DAMPING, period_s, delay)


@DELAYS
@PERIODS
def test_simulated_limit_matches_the_formula(delay: int, period_s: float):
    held = handle(delay, mass_kg=0.5, period_s=period_s)
    assert stiffest_stable_n_per_m(wall, held) == pytest.approx(limit(delay, period_s), rel=0.05)


@DELAYS
def test_simulation_matches_an_independent_one(delay: int):
    held = handle(delay, period_s=0.004)
    exact = exact_stiffness_limit(held.handle, delay)
    assert stiffest_stable_n_per_m(wall, held) == pytest.approx(exact, rel=0.01)


@DELAYS
@pytest.mark.parametrize(
    ("times", "period_s", "jitter", "options"),
    [
        *((times, period_s, 0.0, {}) for times in (1.5, 20.0) for period_s in (0.00025, 0.004)),
        *((3.0, 0.001, jitter, {"passivity": "off"}) for jitter in (0.3, 0.9)),
        (20.0, 0.001, 0.0, {"passivity": "off"}),
        (20.0, 0.001, 0.0, {"passivity": "off", "coupling": "auto"}),
    ],
)
def test_law_of_stated_stiffness_comes_to_rest(delay: int, times: float, period_s: float, jitter: float, options: Any):
    law, held = wall(times * limit(delay, period_s)), handle(delay, period_s=period_s, jitter=jitter)
    assert not comes_to_rest(law, held, (0.0, 0.0, 0.0))
    guard = Safety(delay_ticks=delay, **options).arrays(SPEC, law.stiffness_n_per_m)
    assert comes_to_rest(law, held, (0.0, 0.0, 0.0), guard)


@DELAYS
def test_any_law_behind_the_guard_comes_to_rest(delay: int):
    safety = Safety(delay_ticks=delay)
    found = stiffest_stable_n_per_m(wall, handle(delay), guard=lambda law: safety.arrays(SPEC, law.stiffness_n_per_m))
    assert found > 9e5


@DELAYS
def test_energy_is_at_most_what_the_handle_takes_and_not_positive_if_strict(delay: int):
    law, held = wall(3 * limit(delay)), handle(delay)
    bare = ride(law, held, FALLING, 3.0)
    assert (bare.work_j - bare.lost_j).max() > 1e-4
    safety = Safety(delay_ticks=delay, **AT_ONCE)
    safe = ride(law, held, FALLING, 3.0, safety.arrays(SPEC, law.stiffness_n_per_m))
    assert (safe.work_j - safe.lost_j).max() <= 0
    law, held = wall(3 * limit(delay)), handle(delay)
    safety = Safety(delay_ticks=delay, passivity="strict", **AT_ONCE)
    safe = ride(law, held, FALLING, 3.0, safety.arrays(SPEC, law.stiffness_n_per_m))
    assert safe.work_j[-1] <= 0
    assert safe.work_j.max() < ride(law, held, FALLING, 3.0).work_j.max() / 100


@DELAYS
@pytest.mark.parametrize(
    ("times", "passivity", "resolution_m"), [(1.5, "coupled", 3e-5), (3.0, "strict", 0.0), (5.0, "coupled", 0.0)]
)
def test_law_of_unknown_stiffness_is_damped(delay: int, times: float, passivity: str, resolution_m: float):
    law, held = wall(times * limit(delay)), handle(delay, resolution_m=resolution_m)
    safety = Safety(delay_ticks=delay, passivity=passivity, **AT_ONCE)
    bare, safe = (ride(law, held, FALLING, 4.0, guard) for guard in (None, safety.arrays(SPEC, 0.0)))
    swing, left = (np.ptp(each.place_m[-500:, 2]) for each in (bare, safe))
    assert left < swing / 5
    assert safe.work_j[-1] < bare.work_j[-1] / 5


@DELAYS
def test_spring_within_the_limit_is_not_changed(delay: int):
    law, held = wall(0.79 * limit(delay)), handle(delay)
    bare = ride(law, held, FALLING, 2.0)
    safe = ride(law, held, FALLING, 2.0, Safety(delay_ticks=delay, **AT_ONCE).arrays(SPEC, law.stiffness_n_per_m))
    np.testing.assert_array_equal(safe.force_n, bare.force_n)
