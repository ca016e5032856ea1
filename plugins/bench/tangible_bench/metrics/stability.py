"""The measures of a force law: the greatest stiffness at which a handle comes to rest; and steps, lag and work."""

import math
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from tangible_core.data import Force, HapticState

Law = Callable[[HapticState], Force]
RANGE_N_PER_M = (1.0, 1e6)
CLOSE = 1e-3  # the relative accuracy of a limit
TICKS = 4000
DEPTH_M, PUSHED_M = 1e-3, 1e-4
"""The depth at which the handle rests, and its distance from there at the start, m."""


class Handle(NamedTuple):
    """A handle in a hand, as a mass and a damper along z."""

    mass_kg: float = 0.2
    damping_n_s_per_m: float = 2.0
    period_s: float = 0.001


HANDLE = Handle()


def stiffness_limit(
    law: Callable[[float], Law], height_m: float, delay_ticks: int = 0, handle: Handle = HANDLE
) -> float:
    """Return the stiffness up to which a handle comes to rest on level ground, in N/m, by bisection to 0.1 %.

    law: stiffness in N/m -> forces on ground at height_m. delay_ticks: from the reading of a position to its force.
    Returns: NaN for a force law whose push is not in proportion to its stiffness, infinity for an always stable one.
    """
    low, high = RANGE_N_PER_M
    if not _is_spring(law, height_m):
        return math.nan
    if _comes_to_rest(law(high), height_m, delay_ticks, handle):
        return math.inf
    while high > low * (1 + CLOSE):
        middle = math.sqrt(low * high)
        if _comes_to_rest(law(middle), height_m, delay_ticks, handle):
            low = middle
        else:
            high = middle
    return math.sqrt(low * high)


def advance(
    place_m: float,
    speed_m_per_s: float,
    force_n: float,
    damping_n_s_per_m: float,
    period_s: float,
    decay: float,
    settling_s: float,
) -> tuple[float, float]:
    """Return place and speed after a period under a constant force, m dv/dt = f - b v, exactly; kernels call it too."""
    steady = force_n / damping_n_s_per_m
    off = speed_m_per_s - steady
    return place_m + (steady * period_s + off * settling_s), steady + off * decay


def _is_spring(law: Callable[[float], Law], height_m: float) -> bool:
    soft, hard = (law(stiffness)(HapticState((0.0, 0.0, height_m - DEPTH_M))).z for stiffness in (500.0, 1000.0))
    return soft > 0 and math.isclose(hard, 2 * soft, rel_tol=0.01)


def _comes_to_rest(law: Law, height_m: float, delay_ticks: int, handle: Handle) -> bool:
    """Test whether a handle, pressed down by the force that holds it at DEPTH_M, swings less and less."""
    mass_kg, damping, period_s = handle
    decay = math.exp(-damping * period_s / mass_kg)
    settling_s = (1 - decay) * mass_kg / damping
    rest_m = height_m - DEPTH_M
    push_n = law(HapticState((0.0, 0.0, rest_m))).z
    waiting = deque([push_n] * delay_ticks)
    z, v, swing = rest_m + PUSHED_M, 0.0, [0.0] * 4
    for tick in range(TICKS):
        waiting.append(law(HapticState((0.0, 0.0, z), (0.0, 0.0, v), tick * period_s)).z)
        z, v = advance(z, v, waiting.popleft() - push_n, damping, period_s, decay, settling_s)
        off_m = abs(z - rest_m)
        if off_m > DEPTH_M:
            return False
        swing[4 * tick // TICKS] = max(swing[4 * tick // TICKS], off_m)
    return swing[3] < swing[1]


Vectors = Float64[np.ndarray, "n 3"]  # a vector at each tick


def force_steps(force_n: Vectors) -> dict[str, float]:
    """Return `step_n` and `step_p99_n`: the largest |F(t + T) - F(t)| and its 99th percentile; NaN below two ticks."""
    steps_n = np.linalg.norm(np.diff(force_n, axis=0), axis=1)
    if not steps_n.size:
        return dict.fromkeys(("step_n", "step_p99_n"), float("nan"))
    return {"step_n": float(steps_n.max()), "step_p99_n": float(np.percentile(steps_n, 99))}


def proxy_lag(position_m: Vectors, proxy_m: Vectors, nearest_m: Vectors) -> float:
    """Return the lag of a proxy behind the true one along the hand's motion, |mean of (p - p*) . v / |v||, metres."""
    if len(position_m) < 2:
        return float("nan")
    # Sideways offsets on the way up and on the way down cancel: delay or friction remains.
    motion = np.gradient(position_m, axis=0)
    speed = np.linalg.norm(motion, axis=1)
    offset = ((proxy_m - nearest_m) * motion).sum(axis=1)
    counts = np.isfinite(offset) & (nearest_m != position_m).any(axis=1) & (speed > 0)
    return abs(float((offset[counts] / speed[counts]).mean())) if counts.any() else float("nan")


def loop_works(force_n: Vectors, position_m: Vectors, free: Bool[np.ndarray, "n"]) -> Float64[np.ndarray, "loops"]:
    """Return the work done on the hand by each loop, J: from one tick that is free of contact to the next such tick."""
    # Free ticks can be joined through the air without force: so each loop is closed, and work above 0 is energy given
    # away. The trapezoidal rule is exact for a spring: the energy of sampling and holding is not part of a force law.
    work = ((force_n[1:] + force_n[:-1]) / 2 * np.diff(position_m, axis=0)).sum(axis=1)
    at = np.flatnonzero(free)
    total = np.concatenate([[0.0], np.cumsum(work)])[at]
    return np.diff(total)[np.diff(at) > 1]
