"""The errors of forces along a path against the true ones, their steps, and their work."""

from math import atan2

import numpy as np
from jaxtyping import Bool, Float64

from ..errors import GeometryError

Vectors = Float64[np.ndarray, "n 3"]
MAGNITUDE_JND, DIRECTION_JND_DEG = 0.07, 18.0
"""The just noticeable differences of a force's magnitude and of its direction. Source: Pang, Tan &
Durlach, Manual discrimination of force using active finger motion, Perception & Psychophysics 49 (1991); Barbagli et
al., Haptic discrimination of force direction and the influence of visual information, ACM TAP 3 (2006)."""


def force_errors(force_n: Vectors, truth_n: Vectors) -> dict[str, float]:
    """Measure the errors of forces tick by tick; ticks whose truth is NaN are left out.

    Returns: `error_n`, the root mean square of |F - F*| over the ticks at which either is not zero, in newtons, and
    `error_percent`, that over the root mean square of |F*| at the same ticks; over the ticks at which F* is not zero
    `jnd`, the median number of just noticeable differences, and `noticed_percent`, the share of these ticks with more
    than one; `direction_deg`, the mean angle between the two where neither is zero. At a tick the number is the larger
    of ||F| / |F*| - 1| / 0.07 and of the angle / 18 degrees, the angle counting where there is a force. NaN without
    such a tick.
    Raises: GeometryError if the two differ in length.
    """
    _same_length(force_n, truth_n)
    known = np.isfinite(truth_n).all(axis=1)
    force, truth = force_n[known], truth_n[known]
    size, true_size = np.linalg.norm(force, axis=1), np.linalg.norm(truth, axis=1)
    either, touching, both = (size > 0) | (true_size > 0), true_size > 0, (size > 0) & (true_size > 0)
    error_n = _rms(np.linalg.norm(force - truth, axis=1)[either])
    angle_deg = np.zeros(size.size)
    angle_deg[both] = angles_deg(force[both], truth[both])
    magnitude = np.abs(size[touching] / true_size[touching] - 1) / MAGNITUDE_JND
    jnd = np.maximum(magnitude, angle_deg[touching] / DIRECTION_JND_DEG)
    true_n = _rms(true_size[either])
    return {
        "error_n": error_n,
        "error_percent": 100 * error_n / true_n if true_n else float("nan"),
        "direction_deg": _mean(angle_deg[both]),
        "jnd": float(np.median(jnd)) if jnd.size else float("nan"),
        "noticed_percent": 100 * _mean(jnd > 1),
    }


def angles_deg(first: Vectors, second: Vectors) -> Float64[np.ndarray, "n"]:
    """Return the angles between vectors, 0..180 degrees, exact for small ones too, unlike an arc cosine."""
    across, along = np.linalg.norm(np.cross(first, second), axis=1), (first * second).sum(axis=1)
    # One by one: NumPy's arc tangent of an array has other last bits where AVX-512 is.
    return np.degrees(np.array(list(map(atan2, across.tolist(), along.tolist())), np.float64))


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
    Raises: GeometryError if the three differ in length.
    """
    _same_length(position_m, proxy_m)
    _same_length(position_m, nearest_m)
    if len(position_m) < 2:
        return float("nan")
    motion = np.gradient(position_m, axis=0)
    speed = np.linalg.norm(motion, axis=1)
    offset = ((proxy_m - nearest_m) * motion).sum(axis=1)
    counts = np.isfinite(offset) & (nearest_m != position_m).any(axis=1) & (speed > 0)
    return abs(_mean(offset[counts] / speed[counts]))


def loop_works(force_n: Vectors, position_m: Vectors, free: Bool[np.ndarray, "n"]) -> Float64[np.ndarray, "loops"]:
    """Return the work done on the hand by each loop, J: from one tick that is free of contact to the next such tick.

    Free ticks can be joined by a path through the air without force: so each loop is closed, and work above 0 is
    energy given away. The trapezoidal rule is exact for a spring: the energy of sampling and holding is not part of a
    force law. Ticks before the first free one and after the last belong to no loop.
    Raises: GeometryError if the three differ in length.
    """
    _same_length(force_n, position_m)
    _same_length(force_n, free)
    work = ((force_n[1:] + force_n[:-1]) / 2 * np.diff(position_m, axis=0)).sum(axis=1)
    at = np.flatnonzero(free)
    total = np.concatenate([[0.0], np.cumsum(work)])[at]
    return np.diff(total)[np.diff(at) > 1]


def _same_length(first: np.ndarray, second: np.ndarray) -> None:
    if len(first) != len(second):
        raise GeometryError(f"one has {len(first)} ticks and the other {len(second)}; they must be of one path")


def _rms(values: np.ndarray) -> float:
    return _mean(values**2) ** 0.5


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if values.size else float("nan")
