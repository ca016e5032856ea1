"""The handle of `tangible_bench.metrics.stability` under a compiled force law, with a guard, in three axes."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float64

from tangible_bench.metrics.stability import Handle
from tangible_core.compiled.touch import CompiledTouch

Guard = tuple[np.ndarray, np.ndarray]
"""Settings and memory, as `Safety.arrays` returns them."""
NUDGE_M_PER_S = 1e-3
"""Speed of the nudge: too small for the handle to leave a wall that it is pushed against."""
CALM_M_PER_S = 1e-7
"""Speed that counts as rest."""


@dataclass(frozen=True)
class HandleLoop:
    """A handle with the same mass and damping along each axis, the hand on it, and the loop that drives it."""

    handle: Handle
    push_n: tuple[float, float, float] = (0.0, 0.0, -1.0)
    """Force of the hand."""
    jitter: float = 0.0
    """Relative deviation of the period, drawn uniformly from -jitter to jitter."""
    delay_ticks: int = 0
    """Delay from a position to the arrival of its force."""
    resolution_m: float = 0.0
    """Step of the encoder; 0 for none."""


class Ride(NamedTuple):
    """The motion of a handle, a row a tick; the energies are sums until then."""

    time_s: Float64[np.ndarray, "n"]
    place_m: Float64[np.ndarray, "n 3"]
    """Places that the encoder reports."""
    force_n: Float64[np.ndarray, "n 3"]
    """Forces as sent."""
    work_j: Float64[np.ndarray, "n"]
    """Work of the force law on the handle."""
    lost_j: Float64[np.ndarray, "n"]
    """Energy lost in the handle's damper."""
    state: Float64[np.ndarray, "6"]
    """Position and velocity at the end."""


def ride(
    touch: CompiledTouch, loop: HandleLoop, state: Float64[np.ndarray, "6"], seconds: float, guard: Guard | None = None
) -> Ride:
    """Release the handle at a position and velocity under a force law, through a guard if there is one.

    The force law gets the velocity of each step, as along a path.
    """
    import simulated_handle_kernels

    mass_kg, damping, period_s = loop.handle
    count = round(seconds / period_s)
    periods = period_s * (1 + loop.jitter * np.random.default_rng(0).uniform(-1, 1, count))
    place, sent, (work, lost) = np.empty((count, 3)), np.empty((count, 3)), np.empty((2, count))
    end = np.array(state, np.float64)
    cast(Any, simulated_handle_kernels).ride(
        *(touch.address(), touch.fixed, touch.moving, *(guard or (np.empty(0), np.empty(0)))),
        *(periods, (mass_kg, damping), loop.push_n),
        *(loop.delay_ticks, loop.resolution_m, end, place, sent, work, lost),
    )
    return Ride(np.cumsum(periods) - periods, place, sent, work, lost, end)


def comes_to_rest(
    touch: CompiledTouch, loop: HandleLoop, start_m: tuple[float, float, float], guard: Guard | None = None
) -> bool:
    """Test whether the handle, nudged where it rests under the force law, moves less and less."""
    damped = loop.handle._replace(damping_n_s_per_m=10 * loop.handle.damping_n_s_per_m)
    still = replace(loop, handle=damped, delay_ticks=0)
    rest = ride(touch, still, np.array([*start_m, 0.0, 0.0, 0.0]), 10.0, guard).state
    rest[3:] = 0.0, 0.0, NUDGE_M_PER_S
    steps = np.diff(ride(touch, loop, rest, 6.0, guard).place_m, axis=0) / loop.handle.period_s
    early, late = (np.sqrt(np.mean(part**2)) for part in np.array_split(steps, 6)[1::4])
    return bool(late < max(CALM_M_PER_S, min(early, NUDGE_M_PER_S)))


def stiffest_stable_n_per_m(
    make: Callable[[float], CompiledTouch],
    loop: HandleLoop,
    start_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    guard: Callable[[CompiledTouch], Guard] | None = None,
) -> float:
    """Return the largest stiffness at which the handle comes to rest, from 1 to 1e6 N/m, within 0.5 %."""
    low, high = 1.0, 1e6
    while high > 1.005 * low:
        middle = math.sqrt(low * high)
        touch = make(middle)
        if comes_to_rest(touch, loop, start_m, guard(touch) if guard else None):
            low = middle
        else:
            high = middle
    return low


def exact_stiffness_limit(handle: Handle, delay_ticks: int, damping_n_s_per_m: float = 0.0) -> float:
    """Return the stiffness at which an eigenvalue of the handle on a spring leaves the unit circle, in N/m."""
    mass_kg, damping, period_s = handle
    decay = math.exp(-damping * period_s / mass_kg)
    moved, pushed = (period_s - (1 - decay) * mass_kg / damping) / damping, (1 - decay) / damping

    def stable(stiffness: float) -> bool:
        system = np.zeros((2 + delay_ticks, 2 + delay_ticks))
        system[:2, :2] = [[1, (1 - decay) * mass_kg / damping], [0, decay]]
        force = np.zeros(2 + delay_ticks)
        force[:2] = -stiffness, -damping_n_s_per_m
        if delay_ticks:
            system[2] = force
            system[range(3, 2 + delay_ticks), range(2, 1 + delay_ticks)] = 1
            force = np.eye(2 + delay_ticks)[-1]
        system[0] += moved * force
        system[1] += pushed * force
        return bool(np.abs(np.linalg.eigvals(system)).max() < 1)

    low, high = 1.0, 1e6
    while high > low * 1.00001:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def wall(stiffness_n_per_m: float) -> CompiledTouch:
    """Return a spring below z = 0 without a limit of its depth."""
    import simulated_handle_kernels

    return CompiledTouch(cast(Any, simulated_handle_kernels).wall, (stiffness_n_per_m,), stiffness=stiffness_n_per_m)
