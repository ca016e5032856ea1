"""Rectification: turning two pictures so that every match lies on its own row, where they do not lie so already.

A method that searches along rows works on any pair through `with_rectification`; `calibrated` does the same for
cameras that are known.
"""

import logging
from collections.abc import Callable

import numpy as np
from jaxtyping import Float64

from tangible_core.data import DisparityMap, Views
from tangible_core.data.pictures import to_grey
from tangible_core.errors import PictureError
from tangible_core.plugins.notes import note

from ..sparse.matches import Matches, flow_matches, sift_matches
from ..sparse.off_plane_matches import matches_off
from .epipolar import homogeneous, product
from .fundamental import Fit, eight_point
from .homographies import inverse, transform
from .parallax import Plane, best_plane, only_turned
from .rectified_pair import RectifiedPair, as_it_is, warped
from .rectifying_rotation import LEAST_TRUSTED, RectificationError, different, find_turn, seen_range, threshold_px

logger = logging.getLogger(__name__)

FEWEST_TO_TELL = 20
"""Matches below which nothing is said about a pair: it is taken as it is."""
LEAST_GAIN_PX = 0.2
"""Noise in the matches promises less than this; to turn the pictures for it would only blur them."""
MOSTLY = 0.8
"""Share of the matches on one plane from which a scene is looked through for what stands off it."""
EXCHANGED_PX = -2.0
"""Views are exchanged if all but one match in twenty are below this disparity: parallel cameras give none below 0."""
_VERGED_OR_EXCHANGED = (
    "every disparity is negative: the cameras look towards each other, or the views are exchanged (left is right); "
    "if what is near comes out far, exchange them"
)
_TURNED = (
    "the camera only turned between the two pictures, so nothing in them tells how far anything is; move it sideways"
)
_FLAT = (
    "one plane explains the matches, which leaves open how the cameras stood: the relief is right up to a slant; "
    "have something stand before the plane"
)


def with_rectification(views: Views, estimate: Callable[[Views], DisparityMap]) -> DisparityMap:
    """Disparity of the left view by a method that searches along rows, whatever way the cameras looked.

    Raises: RectificationError if the rows do not correspond and cannot be made to; and what `estimate` raises.
    """
    rectified = rectify(views)
    return rectified.to_original(estimate(rectified.views))


def rectify(
    views: Views, tolerance_px: float = 0.35, matches: Matches | None = None, fit: Fit = eight_point
) -> RectifiedPair:
    """A pair of unknown cameras turned so that its rows correspond.

    Skipped, with the reason in `why`, if the views carry a calibration, if the median vertical offset of their
    matches is within tolerance_px (in large pictures: within 1/8000 of the longer side) already, if turning would not
    lessen it by LEAST_GAIN_PX, or if there are too few matches to tell.
    matches: those to go by; found by optical flow and SIFT when left out. fit: makes F of trusted matches.
    A flat scene is aligned as well, with a warning: it leaves open how the cameras stood, so the left picture stays as
    it is. Where most matches lie on a plane, what stands off it is looked for and tells the rest.
    Views in the wrong order are taken as they are, with a warning: their disparities are negative.
    Raises: PictureError if there is only one view; RectificationError if the rows do not correspond but no geometry, or
    only one that distorts the pictures, explains the matches, or if the camera only turned: that shows no depth.
    """
    if views.right is None:
        raise PictureError("rectification needs two views; give a right one")
    if views.calibration is not None:
        return _left_alone(views, "the views carry the calibration of a rectified pair")
    left, right = to_grey(views.left), to_grey(views.right)
    tolerance_px = max(tolerance_px, max(views.shape) / 8000)
    if matches is None:
        quick = flow_matches(left, right)
        if len(quick.left_px) >= FEWEST_TO_TELL and (offset := _median_offset(quick)) <= tolerance_px:
            _say_if_exchanged(quick.left_px[:, 0] - quick.right_px[:, 0])
            return _left_alone(views, f"already rectified: median vertical offset {offset:.2f} px")
        matches = sift_matches(left, right)
    if len(matches.left_px) < FEWEST_TO_TELL:
        return _left_alone(views, f"only {len(matches.left_px)} matches, too few to tell; taken as rectified")
    if (before := _median_offset(matches)) <= tolerance_px:
        _say_if_exchanged(matches.left_px[:, 0] - matches.right_px[:, 0])
        return _left_alone(views, f"already rectified: median vertical offset {before:.2f} px")
    return _turned(views, matches, before, fit)


def whole_picture_matches(views: Views) -> Matches:
    """By SIFT, of a pair: unlike what is followed from place to place, it leaves out what repeats."""
    if views.right is None:
        raise PictureError("rectification needs two views; give a right one")
    return sift_matches(to_grey(views.left), to_grey(views.right))


def _left_alone(views: Views, why: str, level: int = logging.INFO) -> RectifiedPair:
    note(logger, f"not rectified: {why}", level)
    return as_it_is(views, why)


def _say_if_exchanged(disparity_px: Float64[np.ndarray, "n"]) -> None:
    if _all_negative(disparity_px):
        note(logger, "every disparity is negative: the views seem to be exchanged (left is right)", logging.WARNING)


def _all_negative(disparity_px: Float64[np.ndarray, "n"]) -> bool:
    return bool(np.percentile(disparity_px, 95) < EXCHANGED_PX)


def _median_offset(matches: Matches) -> float:
    return float(np.median(np.abs(matches.row_offset_px)))


def _turned(views: Views, matches: Matches, before: float, fit: Fit) -> RectifiedPair:
    matches = different(matches)
    plane = best_plane(*matches, threshold_px(views.shape))
    if plane is not None and np.mean(plane.near) >= MOSTLY:
        matches = different(_with_those_off(plane, matches, views))
    turn, doubt = find_turn(matches, views.shape, fit)
    disparity, offsets = turn.shifts(matches, views.shape)[turn.trusted].T
    offsets = np.abs(offsets)
    if (after := float(np.median(offsets))) > before - LEAST_GAIN_PX:
        return _left_alone(views, f"turning would not help: median vertical offset {before:.2f} px, then {after:.2f}")
    if len(offsets) >= LEAST_TRUSTED:
        check_homographies(turn.homographies, views.shape, offsets)
    if doubt is not None:
        why = f"matches lie {before:.1f} px off their rows, but how to turn the pictures is not sure: {doubt}"
        return _left_alone(views, why, logging.WARNING)
    if turn.plane is not None:
        if only_turned(turn.plane, *matches, views.shape):
            raise RectificationError(_TURNED)
        note(logger, _FLAT, logging.WARNING)
    if _all_negative(disparity):
        note(logger, _VERGED_OR_EXCHANGED, logging.WARNING)
    why = f"median vertical offset {before:.2f} px, now {after:.2f}"
    lenses = (
        f"; radial distortion of the lenses {turn.radials[0]:.3f}, {turn.radials[1]:.3f}" if any(turn.radials) else ""
    )
    note(logger, f"rectified: {why}{lenses}")
    seen = seen_range(matches.left_px[turn.trusted], disparity)
    return warped(views, turn.homographies, why + lenses, _search_start(disparity), turn.radials, seen)


def _with_those_off(plane: Plane, matches: Matches, views: Views) -> Matches:
    """The matches, and those of what stands before or behind the plane."""
    assert views.right is not None
    off = matches_off(to_grey(views.left), to_grey(views.right), plane.matrix)
    right_px = transform(inverse(plane.matrix), off.right_px)
    return Matches(np.vstack([matches.left_px, off.left_px]), np.vstack([matches.right_px, right_px]))


def _search_start(disparity_px: Float64[np.ndarray, "n"]) -> int:
    """Zero, or a disparity below all but stray matches where the cameras look past each other and some are negative.

    Never above zero: a far wall without detail has no match to speak for it.
    """
    low, high = np.percentile(disparity_px, [1, 99])
    return min(0, int(np.floor(low - max(4.0, 0.1 * (high - low)))))


def check_homographies(
    pair: tuple[np.ndarray, np.ndarray], shape: tuple[int, int], offsets_px: np.ndarray, most_offset_px: float = 3.0
) -> None:
    """Raises: RectificationError if a homography tears, mirrors or resizes a picture, or rows do not correspond.

    The area may change by a factor of three; the 95th percentile of the vertical offsets is most_offset_px at most.
    """
    for side, homography in zip(("left", "right"), pair, strict=True):
        rows, columns = shape
        corners = np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]], np.float64)
        depth = product(homogeneous(corners), homography[2:].T)
        if depth.min() <= 0:
            raise RectificationError(f"the {side} picture would reach infinity: the cameras look along their baseline")
        quad = transform(homography, corners)
        turns = _cross(np.roll(quad, -1, axis=0) - quad, np.roll(quad, -2, axis=0) - np.roll(quad, -1, axis=0))
        if turns.min() <= 0:
            raise RectificationError(f"the {side} picture's corners would change their order")
        ratio = 0.5 * _cross(quad, np.roll(quad, -1, axis=0)).sum() / (rows * columns)
        if not 1 / 3 <= ratio <= 3:
            raise RectificationError(f"the {side} picture would take {ratio:.2g} times its area; turn the cameras less")
    if (worst := float(np.percentile(offsets_px, 95))) > most_offset_px:
        raise RectificationError(
            f"one match in twenty would still lie over {worst:.1f} px off its row: "
            "the camera moved forwards, or a lens distorts"
        )


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
