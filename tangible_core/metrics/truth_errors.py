"""The errors of a disparity map, and of forces along a path, against the truth."""

from math import atan2

import numpy as np
from jaxtyping import Float, Float64

from ..errors import GeometryError, PictureError

BOUNDS_PX = (0.5, 1.0, 2.0, 4.0)


def disparity_errors(disparity_px: Float[np.ndarray, "h w"], truth_px: Float[np.ndarray, "h w"]) -> dict[str, float]:
    """Compute Middlebury's measures of a disparity map; values that are not finite are unknown.

    Returns: `bad0.5`, `bad1`, `bad2`, `bad4`, the share of the pixels with truth whose error is over 0.5, 1, 2 or
    4 px, in percent, where a missing estimate is bad; `average_px` and `rms_px`, the mean and the root mean square
    of the absolute error over the pixels that have both, in px; `density`, the share of the pixels with truth that
    have an estimate, in percent. NaN where there is nothing to measure.
    Raises: PictureError if the two differ in size.
    Source: Scharstein & Szeliski, A Taxonomy and Evaluation of Dense Two-Frame Stereo Correspondence Algorithms,
    IJCV 47 (2002), sec. 5.1; missing estimates as in the Middlebury evaluation, version 3.
    """
    error_px = absolute_error(disparity_px, truth_px)[np.isfinite(truth_px)]
    known_px = error_px[np.isfinite(error_px)]
    bad = {f"bad{limit_px:g}": _percent(~(error_px <= limit_px)) for limit_px in BOUNDS_PX}
    return bad | {"average_px": _mean(known_px), "rms_px": _rms(known_px), "density": _percent(np.isfinite(error_px))}


def absolute_error(
    disparity_px: Float[np.ndarray, "h w"], truth_px: Float[np.ndarray, "h w"]
) -> Float[np.ndarray, "h w"]:
    """Return |estimate - truth| in px, float64 (h, w), NaN where either is unknown."""
    if disparity_px.shape != truth_px.shape:
        raise PictureError(
            f"the disparity map is {disparity_px.shape} and its truth {truth_px.shape}; crop or scale one of them"
        )
    valid_mask = np.isfinite(disparity_px) & np.isfinite(truth_px)
    error_px = np.full(truth_px.shape, np.nan)
    error_px[valid_mask] = np.abs(disparity_px[valid_mask].astype(np.float64) - truth_px[valid_mask])
    return error_px


def _percent(flags: np.ndarray) -> float:
    return 100 * _mean(flags)


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if values.size else float("nan")


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
    valid_mask = np.isfinite(truth_n).all(axis=1)
    force, truth = force_n[valid_mask], truth_n[valid_mask]
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
