"""The errors of a disparity map against the truth."""

import numpy as np
from jaxtyping import Float

from ..errors import PictureError

BOUNDS_PX = (0.5, 1.0, 2.0, 4.0)
"""The errors above which Middlebury's tables count pixels as bad."""


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
    bad = {f"bad{bound:g}": _percent(~(error_px <= bound)) for bound in BOUNDS_PX}
    return bad | {
        "average_px": _mean(known_px),
        "rms_px": _mean(known_px**2) ** 0.5,
        "density": _percent(np.isfinite(error_px)),
    }


def absolute_error(
    disparity_px: Float[np.ndarray, "h w"], truth_px: Float[np.ndarray, "h w"]
) -> Float[np.ndarray, "h w"]:
    """Return |estimate - truth| in px, float64 (h, w), NaN where either is unknown.

    Raises: PictureError if the two differ in size.
    """
    if disparity_px.shape != truth_px.shape:
        raise PictureError(
            f"the disparity map is {disparity_px.shape} and its truth {truth_px.shape}; crop or scale one of them"
        )
    known = np.isfinite(disparity_px) & np.isfinite(truth_px)
    error_px = np.full(truth_px.shape, np.nan)
    error_px[known] = np.abs(disparity_px[known].astype(np.float64) - truth_px[known])
    return error_px


def _percent(flags: np.ndarray) -> float:
    return 100 * _mean(flags)


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if values.size else float("nan")
