"""The measures of the field's benchmarks, and the pixels that both views show."""

import numpy as np
from jaxtyping import Bool, Float

from tangible_core.metrics import absolute_error

QUANTILES = (50, 90, 95, 99)
"""The percentiles of the error in Middlebury's tables."""
KITTI_PX, KITTI_SHARE = 3.0, 0.05
"""KITTI's thresholds of an outlier, whose error is over both, in px and as a share of the true disparity."""
HIDING_STEP_PX = 1.0
"""The step in disparity over which a surface hides another one: a smaller step is a slope."""


def benchmark_errors(
    disparity_px: Float[np.ndarray, "h w"],
    truth_px: Float[np.ndarray, "h w"],
    foreground: Bool[np.ndarray, "h w"] | None = None,
) -> dict[str, float]:
    """Compute the measures of Middlebury's version 3 and of KITTI; values that are not finite are unknown.

    Returns: `a50_px` to `a99_px`, the error that 50 to 99 % of the pixels with both do not exceed, in px; `invalid`,
    the share of the pixels with truth that have no estimate; `bad3`, KITTI 2012's share of outliers, over 3 px; `d1`,
    KITTI 2015's, over 3 px and 5 %; `d1_bg` and `d1_fg`, that of the pixels outside of the foreground and in it; all
    in percent. A missing estimate is bad. `pixels`, `pixels_bg`, `pixels_fg`: how many have truth. NaN where there is
    nothing to measure, or no foreground is given.
    Raises: PictureError if the two differ in size.
    Source: Scharstein et al., High-resolution stereo datasets with subpixel-accurate ground truth, GCPR 2014; Geiger,
    Lenz & Urtasun, Are we ready for autonomous driving?, CVPR 2012; Menze & Geiger, Object scene flow for autonomous
    vehicles, CVPR 2015.
    """
    error_px = absolute_error(disparity_px, truth_px)
    at = np.isfinite(truth_px)
    error, truth = error_px[at], np.abs(truth_px[at])
    known = error[np.isfinite(error)]
    outlier = ~((error <= KITTI_PX) | (error <= KITTI_SHARE * truth))
    quantiles = np.percentile(known, QUANTILES) if known.size else np.full(len(QUANTILES), np.nan)
    errors = {f"a{share}_px": float(value) for share, value in zip(QUANTILES, quantiles, strict=True)}
    errors |= {
        "invalid": _percent(~np.isfinite(error)),
        "bad3": _percent(~(error <= KITTI_PX)),
        "d1": _percent(outlier),
    }
    in_front = None if foreground is None else foreground[at]
    for name, part in (("_bg", None if in_front is None else ~in_front), ("_fg", in_front)):
        errors[f"d1{name}"] = float("nan") if part is None else _percent(outlier[part])
        errors[f"pixels{name}"] = 0.0 if part is None else float(np.count_nonzero(part))
    return errors | {"pixels": float(error.size)}


def visible_pixels(truth_px: Float[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Find the pixels of the left view that the right view shows too, by the true disparity.

    A pixel (row, x) is hidden if x - d lies outside of the right view, or if the truth puts there a surface nearer by
    more than HIDING_STEP_PX. A pixel without truth counts as hidden, and hides nothing.
    Returns: bool (h, w). Exact for whole disparities; otherwise right to a quarter of a pixel at the edges.
    """
    rows, columns = np.nonzero(np.isfinite(truth_px))
    shift_px = truth_px[rows, columns].astype(np.float64)
    target_px = columns - shift_px
    inside = np.rint(target_px).astype(np.int64)
    seen = (inside >= 0) & (inside < truth_px.shape[1])
    nearest_px = np.full(truth_px.shape, -np.inf)
    # Both columns that a pixel lies between, so that a surface that the right view stretches has no gaps.
    for column in (np.floor(target_px + 0.25), np.floor(target_px + 0.75)):
        hit = (column >= 0) & (column < truth_px.shape[1])
        np.maximum.at(nearest_px, (rows[hit], column[hit].astype(np.int64)), shift_px[hit])
    seen[seen] = nearest_px[rows[seen], inside[seen]] <= shift_px[seen] + HIDING_STEP_PX
    visible = np.zeros(truth_px.shape, np.bool_)
    visible[rows, columns] = seen
    return visible


def _percent(flags: np.ndarray) -> float:
    return 100 * float(flags.mean()) if flags.size else float("nan")
