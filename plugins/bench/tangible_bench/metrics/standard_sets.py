"""The measures of the benchmarks of disparity: errors, pixels that both views show, and the quality of a confidence."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float

from tangible_core.metrics import absolute_error

QUANTILES = (50, 90, 95, 99)  # the percentiles of the error in Middlebury's tables
# KITTI's thresholds of an outlier, whose error is over both, in px and as a share of the true disparity.
KITTI_PX, KITTI_SHARE = 3.0, 0.05
# The step in disparity over which a surface hides another one: a smaller step is a slope.
HIDING_STEP_PX = 1.0


def benchmark_errors(
    disparity_px: Float[np.ndarray, "h w"],
    truth_px: Float[np.ndarray, "h w"],
    foreground: Bool[np.ndarray, "h w"] | None = None,
) -> dict[str, float]:
    """Compute the measures of Middlebury's version 3 and of KITTI; values that are not finite are unknown.

    Returns: `a50_px` to `a99_px`, quantiles of the error; `invalid`, `bad3` (KITTI 2012), `d1` (2015: 3 px and 5 %),
    `d1_bg`, `d1_fg` in percent of the pixels with truth, where a missing estimate is bad; and the numbers of pixels.
    Raises: PictureError if the two differ in size.
    Source: Scharstein et al., GCPR 2014; Geiger, Lenz & Urtasun, CVPR 2012; Menze & Geiger, CVPR 2015.
    """
    error_px = absolute_error(disparity_px, truth_px)
    at = np.isfinite(truth_px)
    error, truth = error_px[at], np.abs(truth_px[at])
    finite = error[np.isfinite(error)]
    outlier = ~((error <= KITTI_PX) | (error <= KITTI_SHARE * truth))
    quantiles = np.percentile(finite, QUANTILES) if finite.size else np.full(len(QUANTILES), np.nan)
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

    Returns: bool (h, w). Exact for whole disparities; otherwise right to a quarter of a pixel at the edges.
    """
    # Hidden: outside of the right view, or behind a surface nearer by more than the step. Without truth: hidden too.
    rows, columns = np.nonzero(np.isfinite(truth_px))
    shift_px = truth_px[rows, columns].astype(np.float64)
    target_px = columns - shift_px
    inside = np.rint(target_px).astype(np.int64)
    in_view = (inside >= 0) & (inside < truth_px.shape[1])
    nearest_px = np.full(truth_px.shape, -np.inf)
    # Both columns that a pixel lies between, so that a surface that the right view stretches has no gaps.
    for column in (np.floor(target_px + 0.25), np.floor(target_px + 0.75)):
        hit = (column >= 0) & (column < truth_px.shape[1])
        np.maximum.at(nearest_px, (rows[hit], column[hit].astype(np.int64)), shift_px[hit])
    in_view[in_view] = nearest_px[rows[in_view], inside[in_view]] <= shift_px[in_view] + HIDING_STEP_PX
    visible = np.zeros(truth_px.shape, np.bool_)
    visible[rows, columns] = in_view
    return visible


def _percent(flags: np.ndarray) -> float:
    return 100 * float(flags.mean()) if flags.size else float("nan")


WRONG_PX = 2.0  # the error above which a pixel is wrong, as for `bad2`
LEFT = {removed: f"left_{removed}" for removed in range(0, 100, 5)}
"""The names of the figures by the per cent of a map that are removed."""
LEFT_BY_ORACLE = {removed: f"{name}_by_oracle" for removed, name in LEFT.items()}
"""The names of the figures of the oracle's curve."""


def sparsification_curve(confidence: Float[np.ndarray, " n"], wrong: Bool[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Return the share of wrong pixels among the k most confident ones, 0..1, for k = 1..n."""
    order = np.argsort(-confidence.astype(np.float64), kind="stable")
    sure = confidence[order]
    # Pixels of equal confidence have no order: the value is the expected one over all orders.
    last = np.flatnonzero(np.append(sure[1:] != sure[:-1], sure.size > 0))
    counts = np.arange(1, sure.size + 1)
    wrong_kept = np.cumsum(wrong[order])[last]
    return np.interp(counts, np.append(0, counts[last]), np.append(0, wrong_kept)) / counts


def sparsification_errors(
    disparity_px: Float[np.ndarray, "h w"], confidence: Float[np.ndarray, "h w"], truth_px: Float[np.ndarray, "h w"]
) -> dict[str, float]:
    """Measure how well the confidence of a disparity map separates wrong pixels, over 2 px off or missing, from others.

    Returns, in percent: `left_20` and its like, the share of wrong pixels once the least confident 20 % are removed;
    `ausc`, the mean of the whole curve; both by an oracle, which removes every wrong pixel first. NaN without truth.
    Source: Hu & Mordohai, A Quantitative Evaluation of Confidence Measures for Stereo Vision, PAMI 34(11), 2012.
    """
    has_truth = np.isfinite(truth_px)
    error_px = absolute_error(disparity_px, truth_px)[has_truth]
    wrong = ~(error_px <= WRONG_PX)
    sure = np.where(np.isfinite(error_px), confidence[has_truth], -1.0)
    own = 100 * sparsification_curve(sure, wrong)
    oracle = 100 * sparsification_curve(-wrong.astype(np.float64), wrong)
    area, least = (float(curve.mean()) if curve.size else float("nan") for curve in (own, oracle))
    return (
        _points(own, LEFT)
        | _points(oracle, LEFT_BY_ORACLE)
        | {"ausc": area, "ausc_by_oracle": area / least if least else float("nan")}
    )


def _points(curve: Float[np.ndarray, " n"], names: Mapping[int, str]) -> dict[str, float]:
    """Return the named points of a curve, at one pixel where less than one would be left."""
    ends = {name: max(1, round(curve.size * (100 - percent) / 100)) for percent, name in names.items()}
    return {name: float(curve[count - 1]) if curve.size else float("nan") for name, count in ends.items()}
