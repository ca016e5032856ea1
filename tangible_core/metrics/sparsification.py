"""Whether a map knows where it is wrong: what is left of its wrong pixels as the least confident ones are removed."""

import numpy as np
from jaxtyping import Bool, Float

from .disparity import absolute_error

WRONG_PX = 2.0
"""Error above which a pixel counts as wrong, as for `bad2`."""


def sparsification_curve(confidence: Float[np.ndarray, " n"], wrong: Bool[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Share of wrong pixels among the k most confident ones, 0..1, for k = 1..n.

    Of pixels of one confidence no order is told: the value is the expected one over all orders.
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
    """How well the confidence of a disparity map sorts its wrong pixels, those over 2 px off or missing, from the rest.

    Returns: `ausc`, the area under `sparsification_curve` over the pixels with truth, in percent: that of `bad2` for a
    confidence that says nothing; `ausc_by_oracle`, that over the area of an order that puts every wrong pixel last: 1
    is perfect, and NaN where nothing is wrong. A missing estimate is the least confident. NaN without truth.
    Raises: PictureError if the disparity and its truth differ in size.
    Source: Hu & Mordohai, A Quantitative Evaluation of Confidence Measures for Stereo Vision, PAMI 34(11), 2012.
    """
    measured = np.isfinite(truth_px)
    error_px = absolute_error(disparity_px, truth_px)[measured]
    if not error_px.size:
        return {"ausc": float("nan"), "ausc_by_oracle": float("nan")}
    wrong = ~(error_px <= WRONG_PX)
    sure = np.where(np.isfinite(error_px), confidence[measured], -1.0)
    area = float(sparsification_curve(sure, wrong).mean())
    least = float(sparsification_curve(-wrong.astype(np.float64), wrong).mean())
    return {"ausc": 100 * area, "ausc_by_oracle": area / least if least else float("nan")}
