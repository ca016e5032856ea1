"""Whether left and right were exchanged, as their disparities and what hides what tell.

In a pair in the right order, a larger disparity is nearer. With its views exchanged every disparity has the other sign,
so that parallel cameras give negative ones throughout. But so does a pair in order whose pictures were shifted against
each other, as a stereo card's are. What settles it is occlusion: between two depths, a strip of one view is hidden in
the other, and belongs to what lies behind. The contour, and with it an edge in the picture, is where the strip meets
what lies in front.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32

from ..data import DisparityMap, Views
from ..data.pictures import to_grey

MATCHED = 0.15
"""Confidence above which a disparity was matched, not filled in."""
NEGATIVE_PX = -2.0
"""Disparities are negative throughout if all but one in twenty are below this."""
MOST_ROWS = 512
"""Rows that are looked at, evenly spread."""
LEAST_STEP_PX = 3.0
"""Height of a step between two depths from which it is looked at; and by how much, or by which share, the strip beside
it may differ from it in width."""
STEP_SHARE = 0.4
CLEARER, LEAST_EDGE = 1.5, 0.01
"""An edge at one end of a strip counts if it is so many times the one at the other end, and this part of white more."""
LEAST_MATCHED_TO_JUDGE = 0.2
"""Part of the picture that must be matched before anything is said."""
FEWEST, MAJORITY, MAJORITY_MIXED = 100, 1.8, 2.5
"""Strips that are heard, and how many times as many must speak against what the signs say; the signs of a pair with
disparities of either sign say nothing, and it is taken as in order. Real pairs reach 2.0 to 16."""


class ViewOrder(NamedTuple):
    """What was found out about the order of two views."""

    exchanged: bool
    said: str
    """In words; empty where there is nothing to say."""


IN_ORDER = ViewOrder(False, "")


class _Votes(NamedTuple):
    """Strips whose contour lies where a larger disparity is nearer, and where it is farther."""

    in_order: int
    exchanged: int


def view_order(disparity: DisparityMap, left: np.ndarray, offset_px: float = 0.0) -> ViewOrder:
    """Whether the views were exchanged that this map was found in.

    left: the picture that the map belongs to. offset_px: what is added to a disparity before it is a distance.
    """
    if disparity.unit != "px":
        return IN_ORDER
    count = min(MOST_ROWS, left.shape[0])
    rows = np.arange(count) * left.shape[0] // count
    values, confidence = disparity.disparity_px[rows], disparity.confidence[rows]
    matched = np.isfinite(values) & (confidence > MATCHED)
    if matched.mean() < LEAST_MATCHED_TO_JUDGE:
        return IN_ORDER
    low, high = np.percentile(values[matched], [5, 95])
    if low > NEGATIVE_PX:
        return IN_ORDER
    votes = _votes(np.where(matched, values, np.float32(np.nan)), to_grey(left[rows]))
    if high < NEGATIVE_PX:
        return _of_negative(votes, explained=bool(low + offset_px > 0))
    if sum(votes) < FEWEST or votes.exchanged < MAJORITY_MIXED * votes.in_order:
        return IN_ORDER
    return _exchanged(f"{votes.exchanged} of {sum(votes)} contours hide what they hide in exchanged views alone")


def _of_negative(votes: _Votes, explained: bool) -> ViewOrder:
    """Where every disparity is negative. explained: the cameras are known, and give such ones."""
    if explained:
        return IN_ORDER
    if sum(votes) >= FEWEST and votes.in_order >= MAJORITY * votes.exchanged:
        hide = f"{votes.in_order} of {sum(votes)} contours hide what they hide in this order alone"
        return ViewOrder(False, f"every disparity is negative, and yet left and right are in order: {hide}")
    return _exchanged("every disparity is negative")


def _exchanged(reason: str) -> ViewOrder:
    return ViewOrder(
        True,
        f"left and right seem to be exchanged: {reason}. The depth was put right, and lies under the picture that is "
        "named left. Exchange the two names; or, if they are in order, write `order: as-named` under `scene:`",
    )


def put_right(disparity: DisparityMap) -> DisparityMap:
    """The map of exchanged views with larger disparities nearer, still of the picture that it was found for."""
    return DisparityMap(-disparity.disparity_px, disparity.confidence, disparity.unit)


def _votes(values: Float32[np.ndarray, "h w"], grey: Float32[np.ndarray, "h w"]) -> _Votes:
    """values: NaN where nothing was matched."""
    known_rows, known_columns = np.nonzero(~np.isnan(values))
    same_row = known_rows[1:] == known_rows[:-1]
    row, before, after = (each[same_row] for each in (known_rows[1:], known_columns[:-1], known_columns[1:]))
    step, width = values[row, after] - values[row, before], after - before - 1
    fits = (step >= LEAST_STEP_PX) & (np.abs(width - step) <= np.maximum(2, STEP_SHARE * step))
    inside = (before >= 3) & (after < values.shape[1] - 3)
    row, before, after = (each[fits & inside] for each in (row, before, after))
    slope = _slope(grey)
    at_before, at_after = slope[row, before], slope[row, after]
    return _Votes(
        int(np.count_nonzero(at_after > CLEARER * at_before + LEAST_EDGE)),
        int(np.count_nonzero(at_before > CLEARER * at_after + LEAST_EDGE)),
    )


def _slope(grey: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """The steepest slope along the row within one pixel."""
    slope = np.zeros_like(grey)
    slope[:, 1:-1] = np.abs(grey[:, 2:] - grey[:, :-2]) / 2
    steepest = slope.copy()
    np.maximum(steepest[:, 1:], slope[:, :-1], out=steepest[:, 1:])
    np.maximum(steepest[:, :-1], slope[:, 1:], out=steepest[:, :-1])
    return steepest


LEAST_MATCHED = 0.25
"""Part of the picture below which hardly anything was matched: good pairs reach 0.5 to 0.9, noise 0.02 to 0.12."""


def same_twice(views: Views, disparity: DisparityMap) -> str:
    """What to say of a depth that was asked of one picture twice; empty of two pictures, or where one is enough."""
    if disparity.unit != "px" or views.right is None or not np.array_equal(views.left, views.right):
        return ""
    return (
        "left and right are one and the same picture: nothing has moved between them, so no depth can be seen and the "
        "surface is flat. Name the two pictures of a pair, taken from side by side, or this one alone as a photo"
    )


def hardly_matched(disparity: DisparityMap, known: Bool[np.ndarray, "h w"] | None = None) -> str:
    """What to say of a map that is mostly filled in, with likely causes and cures; empty where enough was matched.

    known: where the picture shows anything.
    """
    matched = np.isfinite(disparity.disparity_px) & (disparity.confidence > MATCHED)
    shown = matched if known is None else matched[known]
    if disparity.unit != "px" or shown.size == 0 or (share := float(shown.mean())) >= LEAST_MATCHED:
        return ""
    return (
        f"hardly anything matches in the two pictures: a depth was found for {share:.0%} of the left one, and the rest "
        "is filled in. Check that both show the same scene at the same time, from side by side and equally sharp, and "
        "that left and right are not exchanged; let pictures of cameras that did not look in parallel be turned "
        "(`rectify: auto`); search a wider range (`max_disparity_px`); or try another depth method"
    )
