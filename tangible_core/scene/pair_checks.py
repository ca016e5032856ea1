"""Checks of a pair's disparity: exchanged views, the same picture twice, hardly any match."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32

from ..data import DisparityMap, Views
from ..data.pictures import to_grey

MATCHED = 0.15
# Disparities count as negative throughout if all but one in twenty are below this.
NEGATIVE_PX = -2.0
MAX_ROWS = 512
MIN_STEP_PX = 3.0
# Largest difference between a step and the width of its strip, as a share of the step; 2 px are always allowed.
STEP_SHARE = 0.4
# Factor by which the edge at one end of a strip must exceed the other, plus this share of white.
CLEARER, MIN_EDGE = 1.5, 0.01
MIN_MATCHED_TO_JUDGE = 0.2  # smallest matched share of the picture for a judgement on the order
MIN_STRIPS, MAJORITY = 20, 1.8
"""Fewest strips that decide where disparities are negative throughout, and the ratio of their votes."""
MIN_STRIPS_AGAINST, MAJORITY_MIXED, MAJORITY_POSITIVE = 50, 2.0, 3.0
"""The same to overrule an order that mixed signs, or positive ones throughout, allow. Real pairs reach 2 to 40."""
# Share of the picture below which hardly anything was matched: good pairs reach 0.5 to 0.9, noise 0.02 to 0.12.
MIN_MATCHED = 0.25


class ViewOrder(NamedTuple):
    """The order of two views as their disparity shows it."""

    exchanged: bool
    message: str
    open: bool = False  # true if the disparities are odd for this order, and the contours do not decide


IN_ORDER = ViewOrder(False, "")


class _Votes(NamedTuple):
    """Numbers of strips whose contour shows that a larger disparity is nearer, and that it is farther."""

    in_order: int
    exchanged: int


def view_order(disparity: DisparityMap, left: np.ndarray, offset_px: float | None = None) -> ViewOrder:
    """Judge from the disparity map of the picture `left` whether its views were exchanged; offset_px: the cameras'."""
    if disparity.unit != "px":
        return IN_ORDER
    count = min(MAX_ROWS, left.shape[0])
    rows = np.arange(count) * left.shape[0] // count
    values, confidence = disparity.disparity_px[rows], disparity.confidence[rows]
    valid_mask = np.isfinite(values) & (confidence > MATCHED)
    if valid_mask.mean() < MIN_MATCHED_TO_JUDGE:
        return IN_ORDER
    low, high = np.percentile(values[valid_mask], [5, 95])
    if offset_px is not None and low > NEGATIVE_PX:
        return IN_ORDER
    # In a pair in order, a larger disparity is nearer. Exchanged views have the other sign throughout, but so does a
    # pair in order whose pictures were shifted, as a stereo card's. Occlusion decides: between two depths, a strip of
    # one view is hidden in the other and belongs to the farther surface; the contour is at its end at the nearer one.
    votes = _votes(np.where(valid_mask, values, np.float32(np.nan)), to_grey(left[rows]))
    if high < NEGATIVE_PX:
        return IN_ORDER if low + (offset_px or 0.0) > 0 else _of_negative(votes)
    majority = MAJORITY_MIXED if low <= NEGATIVE_PX else MAJORITY_POSITIVE
    if sum(votes) < MIN_STRIPS_AGAINST or votes.exchanged < majority * votes.in_order:
        return IN_ORDER
    return _as_exchanged(f"{votes.exchanged} of {sum(votes)} contours occlude as in exchanged views")


def _of_negative(votes: _Votes) -> ViewOrder:
    """Judge a map whose disparities are all negative: of exchanged views, or of pictures that were shifted."""
    count, enough = sum(votes), sum(votes) >= MIN_STRIPS
    if enough and votes.in_order >= MAJORITY * votes.exchanged:
        reason = f"{votes.in_order} of {count} contours occlude as in this order"
        return ViewOrder(False, f"every disparity is negative, and yet left and right are in order: {reason}")
    if enough and votes.exchanged >= MAJORITY * votes.in_order:
        reason = f"{votes.exchanged} of {count} contours occlude as in exchanged views"
        return _as_exchanged(f"every disparity is negative, and {reason}")
    return ViewOrder(
        False,
        f"it is open whether left and right are exchanged: every disparity is negative, and {votes.in_order} contours "
        f"occlude as in this order, {votes.exchanged} as in exchanged views. The order was left as it is. If near "
        "things feel far, exchange the two names; or, if they are in order, write `order: as-named` under `scene:`",
        open=True,
    )


def _as_exchanged(reason: str) -> ViewOrder:
    return ViewOrder(
        True,
        f"left and right seem to be exchanged: {reason}. The depth was corrected, and belongs to the picture that is "
        "named left. Exchange the two names; or, if they are in order, write `order: as-named` under `scene:`",
    )


def correct_exchanged(disparity: DisparityMap) -> DisparityMap:
    """Return the map of exchanged views with larger disparities nearer, for the same picture."""
    return DisparityMap(-disparity.disparity_px, disparity.confidence, disparity.unit)


def _votes(values: Float32[np.ndarray, "h w"], grey: Float32[np.ndarray, "h w"]) -> _Votes:
    known_rows, known_columns = np.nonzero(~np.isnan(values))
    same_row = known_rows[1:] == known_rows[:-1]
    row, before, after = (values_at[same_row] for values_at in (known_rows[1:], known_columns[:-1], known_columns[1:]))
    step, width = values[row, after] - values[row, before], after - before - 1
    fits = (step >= MIN_STEP_PX) & (np.abs(width - step) <= np.maximum(2, STEP_SHARE * step))
    inside = (before >= 3) & (after < values.shape[1] - 3)
    row, before, after = (values_at[fits & inside] for values_at in (row, before, after))
    slope = _slope(grey)
    at_before, at_after = slope[row, before], slope[row, after]
    return _Votes(
        int(np.count_nonzero(at_after > CLEARER * at_before + MIN_EDGE)),
        int(np.count_nonzero(at_before > CLEARER * at_after + MIN_EDGE)),
    )


def _slope(grey: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    slope = np.zeros_like(grey)
    slope[:, 1:-1] = np.abs(grey[:, 2:] - grey[:, :-2]) / 2
    steepest = slope.copy()
    np.maximum(steepest[:, 1:], slope[:, :-1], out=steepest[:, 1:])
    np.maximum(steepest[:, :-1], slope[:, 1:], out=steepest[:, :-1])
    return steepest


def identical_views(views: Views, disparity: DisparityMap) -> str:
    """Return a warning if depth was matched between a picture and itself; empty otherwise."""
    if disparity.unit != "px" or views.right is None or not np.array_equal(views.left, views.right):
        return ""
    return (
        "left and right are one and the same picture: nothing has moved between them, so no depth can be seen and the "
        "surface is flat. Name the two pictures of a pair, taken from side by side, or this one alone as a photo"
    )


def few_matches(disparity: DisparityMap, known: Bool[np.ndarray, "h w"] | None = None) -> str:
    """Return a warning, with likely causes and cures, for a map that is mostly filled in; empty otherwise."""
    valid_mask = np.isfinite(disparity.disparity_px) & (disparity.confidence > MATCHED)
    visible = valid_mask if known is None else valid_mask[known]
    if disparity.unit != "px" or visible.size == 0 or (share := float(visible.mean())) >= MIN_MATCHED:
        return ""
    return (
        f"hardly anything matches in the two pictures: a depth was found for {share:.0%} of the left one, and the rest "
        "is filled in. Check that both show the same scene at the same time, from side by side and equally sharp, and "
        "that left and right are not exchanged; rectify pictures of cameras that did not look in parallel "
        "(`rectify: auto`); search a wider range (`max_disparity_px`); or try another depth method"
    )
