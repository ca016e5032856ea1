"""The quality of a map's confidence: the share of wrong pixels as the least confident pixels are removed."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float

from tangible_core.metrics import absolute_error

WRONG_PX = 2.0
"""The error above which a pixel is wrong, as for `bad2`."""
LEFT = {removed: f"left_{removed}" for removed in range(0, 100, 5)}
"""The names of the figures by the per cent of a map that are removed."""
LEFT_BY_ORACLE = {removed: f"{name}_by_oracle" for removed, name in LEFT.items()}
"""The names of the figures of the oracle's curve."""


def sparsification_curve(confidence: Float[np.ndarray, " n"], wrong: Bool[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Return the share of wrong pixels among the k most confident ones, 0..1, for k = 1..n.

    Pixels of equal confidence have no order: the value is the expected one over all orders.
    """
    order = np.argsort(-confidence.astype(np.float64), kind="stable")
    sure = confidence[order]
    last = np.flatnonzero(np.append(sure[1:] != sure[:-1], sure.size > 0))
    kept = np.arange(1, sure.size + 1)
    wrong_kept = np.cumsum(wrong[order])[last]
    return np.interp(kept, np.append(0, kept[last]), np.append(0, wrong_kept)) / kept


def sparsification_errors(
    disparity_px: Float[np.ndarray, "h w"], confidence: Float[np.ndarray, "h w"], truth_px: Float[np.ndarray, "h w"]
) -> dict[str, float]:
    """Measure how well the confidence of a disparity map separates wrong pixels, over 2 px off or missing, from others.

    Returns, in percent: `left_20` and its like, the share of wrong pixels among those left when the least confident
    20 % of the pixels with truth are removed, for each of LEFT, and `left_20_by_oracle`, the same for an order that
    removes every wrong pixel first; `ausc`, the mean of the whole `sparsification_curve`, which is `bad2` if confidence
    is constant. And `ausc_by_oracle`, `ausc` over the oracle's: 1 is perfect, and NaN without wrong pixels. A missing
    estimate is the least confident. NaN without truth.
    Raises: PictureError if the disparity and its truth differ in size.
    Source: Hu & Mordohai, A Quantitative Evaluation of Confidence Measures for Stereo Vision, PAMI 34(11), 2012.
    """
    measured = np.isfinite(truth_px)
    error_px = absolute_error(disparity_px, truth_px)[measured]
    wrong = ~(error_px <= WRONG_PX)
    sure = np.where(np.isfinite(error_px), confidence[measured], -1.0)
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
    kept = {name: max(1, round(curve.size * (100 - removed) / 100)) for removed, name in names.items()}
    return {name: float(curve[count - 1]) if curve.size else float("nan") for name, count in kept.items()}
