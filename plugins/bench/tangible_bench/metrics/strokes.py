"""The measures of a force law along the path of a hand: steps, lag, and work."""

import numpy as np
from jaxtyping import Bool, Float64

Vectors = Float64[np.ndarray, "n 3"]
"""A vector at each tick."""


def force_steps(force_n: Vectors) -> dict[str, float]:
    """Return `step_n` and `step_p99_n`, the largest |F(t + T) - F(t)| in newtons, and its 99th percentile.

    NaN for less than two ticks.
    """
    steps_n = np.linalg.norm(np.diff(force_n, axis=0), axis=1)
    if not steps_n.size:
        return dict.fromkeys(("step_n", "step_p99_n"), float("nan"))
    return {"step_n": float(steps_n.max()), "step_p99_n": float(np.percentile(steps_n, 99))}


def proxy_lag(position_m: Vectors, proxy_m: Vectors, nearest_m: Vectors) -> float:
    """Return the lag of a proxy behind the true one along the hand's motion: |mean of (p - p*) . v / |v||, in metres.

    The mean is over the ticks in contact (p* is not the hand itself) at which the hand moves; v is the central
    difference of its positions. Sideways offsets on the way up and on the way down cancel: delay or friction is left.
    NaN without such a tick.
    """
    if len(position_m) < 2:
        return float("nan")
    motion = np.gradient(position_m, axis=0)
    speed = np.linalg.norm(motion, axis=1)
    offset = ((proxy_m - nearest_m) * motion).sum(axis=1)
    counts = np.isfinite(offset) & (nearest_m != position_m).any(axis=1) & (speed > 0)
    return abs(float((offset[counts] / speed[counts]).mean())) if counts.any() else float("nan")


def loop_works(force_n: Vectors, position_m: Vectors, free: Bool[np.ndarray, "n"]) -> Float64[np.ndarray, "loops"]:
    """Return the work done on the hand by each loop, J: from one tick that is free of contact to the next such tick.

    Free ticks can be joined by a path through the air without force: so each loop is closed, and work above 0 is
    energy given away. The trapezoidal rule is exact for a spring: the energy of sampling and holding is not part of a
    force law. Ticks before the first free one and after the last belong to no loop.
    """
    work = ((force_n[1:] + force_n[:-1]) / 2 * np.diff(position_m, axis=0)).sum(axis=1)
    at = np.flatnonzero(free)
    total = np.concatenate([[0.0], np.cumsum(work)])[at]
    return np.diff(total)[np.diff(at) > 1]
