"""A simulated handle on a force law: how stiff a law it holds, and what energy the law gives away.

The handle is a mass with damping that a hand pushes with a constant force. It moves exactly as it would under a force
that is held from tick to tick, so that nothing but the law and its sampling can make it unstable.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float64

from tangible_core.compiled.touch import CompiledTouch

Guard = tuple[np.ndarray, np.ndarray]
"""Settings and memory, as `Safety.arrays` gives them."""
NUDGE_M_PER_S, CALM_M_PER_S = 1e-3, 1e-7
"""Small enough not to leave a wall that it is pushed against; and as good as rest."""


@dataclass(frozen=True)
class Handle:
    """A grip with mass and damping, alike along each axis, and the loop that drives it."""

    mass_kg: float = 0.5
    damping_n_s_per_m: float = 2.0
    push_n: tuple[float, float, float] = (0.0, 0.0, -1.0)
    """The hand."""
    period_s: float = 0.001
    jitter: float = 0.0
    """Each period is drawn evenly from period_s (1 - jitter) to period_s (1 + jitter)."""
    delay_ticks: int = 0
    """From the position to the force's arrival."""
    resolution_m: float = 0.0
    """Step of the encoder; 0 for none."""


class Ride(NamedTuple):
    """A row a tick; the energies are those until then."""

    time_s: Float64[np.ndarray, "n"]
    place_m: Float64[np.ndarray, "n 3"]
    """As the encoder says it."""
    force_n: Float64[np.ndarray, "n 3"]
    """As it was sent."""
    work_j: Float64[np.ndarray, "n"]
    """Done by the law on the handle."""
    lost_j: Float64[np.ndarray, "n"]
    """In the handle's damper."""
    state: Float64[np.ndarray, "6"]
    """Position and velocity at the end."""


def ride(
    touch: CompiledTouch, handle: Handle, state: Float64[np.ndarray, "6"], seconds: float, guard: Guard | None = None
) -> Ride:
    """The handle let go at a position and velocity, under a law; through a guard if there is one.

    The law is given the velocity of each step, as along a path.
    """
    import simulated_handle_kernels

    count = round(seconds / handle.period_s)
    periods = handle.period_s * (1 + handle.jitter * np.random.default_rng(0).uniform(-1, 1, count))
    place, sent, (work, lost) = np.empty((count, 3)), np.empty((count, 3)), np.empty((2, count))
    end, body = np.array(state, np.float64), (handle.mass_kg, handle.damping_n_s_per_m)
    cast(Any, simulated_handle_kernels).ride(
        *(touch.address(), touch.fixed, touch.moving, *(guard or (np.empty(0), np.empty(0)))),
        *(periods, body, handle.push_n),
        *(handle.delay_ticks, handle.resolution_m, end, place, sent, work, lost),
    )
    return Ride(np.cumsum(periods) - periods, place, sent, work, lost, end)


def comes_to_rest(
    touch: CompiledTouch, handle: Handle, start_m: tuple[float, float, float], guard: Guard | None = None
) -> bool:
    """Whether the handle, nudged where it rests under the law, moves less and less.

    It is brought to rest by tenfold damping, nudged upwards, and watched for six seconds.
    """
    still = replace(handle, damping_n_s_per_m=10 * handle.damping_n_s_per_m, delay_ticks=0)
    rest = ride(touch, still, np.array([*start_m, 0.0, 0.0, 0.0]), 10.0, guard).state
    rest[3:] = 0.0, 0.0, NUDGE_M_PER_S
    steps = np.diff(ride(touch, handle, rest, 6.0, guard).place_m, axis=0) / handle.period_s
    early, late = (np.sqrt(np.mean(part**2)) for part in np.array_split(steps, 6)[1::4])
    return bool(late < max(CALM_M_PER_S, min(early, NUDGE_M_PER_S)))


def stiffest_stable_n_per_m(
    make: Callable[[float], CompiledTouch],
    handle: Handle,
    start_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    guard: Callable[[CompiledTouch], Guard] | None = None,
) -> float:
    """The stiffest law of a family on which the handle comes to rest, from 1 to 1e6 N/m, found within 0.5 %.

    make: the law of a stiffness. guard: that of a law; none if left out.
    """
    low, high = 1.0, 1e6
    while high > 1.005 * low:
        middle = math.sqrt(low * high)
        touch = make(middle)
        if comes_to_rest(touch, handle, start_m, guard(touch) if guard else None):
            low = middle
        else:
            high = middle
    return low


def wall(stiffness_n_per_m: float) -> CompiledTouch:
    """A spring below z = 0 that stretches without end."""
    import simulated_handle_kernels

    return CompiledTouch(cast(Any, simulated_handle_kernels).wall, (stiffness_n_per_m,), stiffness=stiffness_n_per_m)
