"""Rectification: warping two pictures so that every match lies on its own row: the entry to this room."""

import logging
from collections.abc import Callable

import numpy as np
from jaxtyping import Float64

from tangible_core.data import DisparityMap, Views, to_grey
from tangible_core.errors import PictureError
from tangible_core.plugins import note

from ..sparse.matches import NO_MATCHES, Matches, flow_matches, match_off_plane, sift_matches
from .fundamental import Fit, best_plane, eight_point
from .projective import (
    RectifiedPair,
    homogeneous,
    inverse,
    is_pure_rotation,
    product,
    transform,
    unchanged_pair,
    warp_pair,
)
from .rectifying_rotation import MIN_TRUSTED, RectificationError, find_rotation, threshold_px

logger: logging.Logger = logging.getLogger(__name__)

# Fewest matches that decide about a pair; with fewer, it is taken as rectified.
FEWEST_TO_TELL = 20
# Smallest gain in median row offset, in pixels, above the noise of the matches; for less, warping would only blur.
MIN_GAIN_PX = 0.2
# Share of the matches on one plane from which more matches off the plane are searched.
MOSTLY = 0.8
# Nearest matches of a match, and how many must have a similar disparity for it to widen the range.
NEIGHBOURS, MIN_LIKE = 8, 4
STRAY = 0.5  # percentage of similar matches at either end that is dropped as stray
LIKE_PX, LIKE_SLOPE = 8.0, 0.1
"""Largest difference of similar disparities, in pixels, and its growth per pixel between the matches."""
# Disparity, in pixels, below which 95 % of the matches of exchanged views lie: parallel cameras give none below 0.
EXCHANGED_PX = -2.0
_VERGED_OR_EXCHANGED = (
    "every disparity is negative: the cameras look towards each other, or the views are exchanged (left is right); "
    "if near objects come out far, exchange them"
)
_PURE_ROTATION = "the camera only turned between the two pictures, so they contain no depth; move it sideways"
_FLAT_SCENE = (
    "one plane explains the matches, so the cameras' poses stay ambiguous: the relief is right up to a slant; "
    "add an object in front of the plane"
)


def estimate_rectified(views: Views, estimate: Callable[[Views], DisparityMap]) -> DisparityMap:
    """Estimate the left view's disparity by a method that searches along rows. Raises: as `rectify` and `estimate`."""
    pair = rectify(views)
    return pair.to_original(estimate(pair.views))


def rectify(
    views: Views, tolerance_px: float = 0.35, matches: Matches | None = None, fit: Fit = eight_point, quick: bool = True
) -> RectifiedPair:
    """Rectify a pair of unknown cameras, so that its rows correspond. Raises: PictureError, RectificationError."""
    if views.right is None:
        raise PictureError("rectification needs two views; give a right one")
    if views.calibration is not None:
        return _keep_pair(views, "the views have the calibration of a rectified pair")
    left, right = to_grey(views.left), to_grey(views.right)
    tolerance_px = max(tolerance_px, max(views.shape) / 8000)
    if matches is None:
        # Repetitive texture misleads optical flow, unlike SIFT.
        matches = flow_matches(left, right) if quick else NO_MATCHES
        if len(matches.left_px) < FEWEST_TO_TELL or _median_offset(matches) > tolerance_px:
            matches = sift_matches(left, right)
    if len(matches.left_px) < FEWEST_TO_TELL:
        return _keep_pair(views, f"only {len(matches.left_px)} matches, too few to decide; taken as rectified")
    # Warping for less than MIN_GAIN_PX would only blur. A flat scene is aligned too, with a warning: the cameras' poses
    # stay ambiguous. Exchanged views are not swapped, but a warning says so: their disparities are negative.
    if (before := _median_offset(matches)) > tolerance_px:
        return _rotate(views, left, right, matches, before, fit)
    if _all_negative(matches.left_px[:, 0] - matches.right_px[:, 0]):
        from ..search.disparity_range import ALL_NEGATIVE

        note(logger, ALL_NEGATIVE, logging.WARNING)
    return _keep_pair(views, f"already rectified: median vertical offset {before:.2f} px")


def _keep_pair(views: Views, why: str, level: int = logging.INFO) -> RectifiedPair:
    note(logger, f"not rectified: {why}", level)
    return unchanged_pair(views, why)


def _all_negative(disparity_px: Float64[np.ndarray, "n"]) -> bool:
    return bool(np.percentile(disparity_px, 95) < EXCHANGED_PX)


def _median_offset(matches: Matches) -> float:
    return float(np.median(np.abs(matches.right_px[:, 1] - matches.left_px[:, 1])))


def _rotate(
    views: Views, left: np.ndarray, right: np.ndarray, matches: Matches, before: float, fit: Fit
) -> RectifiedPair:
    matches = unique_matches(matches)
    plane = best_plane(matches, threshold_px(views.shape))
    if plane is not None and np.mean(plane.near) >= MOSTLY:
        off = match_off_plane(left, right, plane.matrix)
        right_px = transform(inverse(plane.matrix), off.right_px)
        both = np.vstack([matches.left_px, off.left_px]), np.vstack([matches.right_px, right_px])
        matches = unique_matches(Matches(*both))
    rotation, doubt = find_rotation(matches, views.shape, fit)
    disparity, offsets = rotation.shifts(matches, views.shape)[rotation.inliers].T
    offsets = np.abs(offsets)
    if (after := float(np.median(offsets))) > before - MIN_GAIN_PX:
        return _keep_pair(views, f"rectifying would not help: median vertical offset {before:.2f} px, then {after:.2f}")
    if len(offsets) >= MIN_TRUSTED:
        check_homographies(rotation.homographies, views.shape, offsets)
    if doubt is not None:
        why = f"matches lie {before:.1f} px off their rows, but the rectification is uncertain: {doubt}"
        return _keep_pair(views, why, logging.WARNING)
    if rotation.plane is not None:
        if is_pure_rotation(rotation.plane, matches, views.shape):
            raise RectificationError(_PURE_ROTATION)
        note(logger, _FLAT_SCENE, logging.WARNING)
    if _all_negative(disparity):
        note(logger, _VERGED_OR_EXCHANGED, logging.WARNING)
    why = f"median vertical offset {before:.2f} px, now {after:.2f}"
    lenses = (
        f"; radial distortion of the lenses {rotation.radials[0]:.3f}, {rotation.radials[1]:.3f}"
        if any(rotation.radials)
        else ""
    )
    note(logger, f"rectified: {why}{lenses}")
    verified_px = verified_range(matches.left_px[rotation.inliers], disparity)
    return warp_pair(
        views, rotation.homographies, why + lenses, _search_start(disparity), rotation.radials, verified_px
    )


def _search_start(disparity_px: Float64[np.ndarray, "n"]) -> int:
    """Return zero, or a disparity below all but stray matches if the cameras diverge and some are negative."""
    low, high = np.percentile(disparity_px, [1, 99])
    # Never above zero, as a far wall without detail has no matches.
    return min(0, int(np.floor(low - max(4.0, 0.1 * (high - low)))))


def verified_range(points_px: np.ndarray, disparity_px: np.ndarray) -> tuple[int, int]:
    """Return the lowest and highest disparity, except STRAY, of matches with similar neighbours; of all without any."""
    from scipy.spatial import KDTree

    # A match on its row may still have a wrong column.
    away, nearest = KDTree(points_px).query(points_px, min(NEIGHBOURS + 1, len(points_px)))
    differing = np.abs(disparity_px[nearest] - disparity_px[:, None])
    like = np.count_nonzero(differing <= LIKE_PX + LIKE_SLOPE * away, axis=1) > MIN_LIKE
    disparities_px = disparity_px[like] if like.any() else disparity_px
    low, high = np.percentile(disparities_px, [STRAY, 100 - STRAY])
    return int(np.floor(low)), int(np.ceil(high))


def check_homographies(
    pair: tuple[np.ndarray, np.ndarray], shape: tuple[int, int], offsets_px: np.ndarray, most_offset_px: float = 3.0
) -> None:
    """Check homographies. Raises: RectificationError if one tears, mirrors or resizes a picture, or rows differ."""
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


def unique_matches(matches: Matches) -> Matches:
    """Remove duplicate matches, which could validate themselves."""
    _, first = np.unique(np.hstack(matches), axis=0, return_index=True)
    return matches.select(np.sort(first))
