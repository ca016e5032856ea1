"""The errors of forces along a path against the true ones, their steps, and their work."""

from math import atan2

import numpy as np
from jaxtyping import Float64

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
    if len(force_n) != len(truth_n):
        raise GeometryError(f"one has {len(force_n)} ticks and the other {len(truth_n)}; they must be of one path")
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


def _rms(values: np.ndarray) -> float:
    return _mean(values**2) ** 0.5


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if values.size else float("nan")
