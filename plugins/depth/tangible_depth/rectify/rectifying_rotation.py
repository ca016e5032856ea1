"""The rectifying rotation of two pictures, which brings their matches onto common rows, and its evidence."""

import logging
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from tangible_core.errors import GeometryError

from ..sparse.matches import Matches
from .alignment import aligning_homographies, aligning_lenses, epipole_roll
from .fundamental import DegenerateMatches, Fit, robust_fundamental
from .parallax import Plane, best_plane
from .projective import transform, undistort

logger: logging.Logger = logging.getLogger(__name__)

LEAST_TRUSTED = 30
"""Fewest inliers of a trusted geometry: a few wrong matches agree on one by chance."""
PARTS = 4
"""Rows and columns into which the left picture is divided."""
LEAST_PARTS = 5
"""Fewest of the PARTS x PARTS parts that must contain inliers."""
LEAST_KEPT = 0.5
"""Lowest share of held-out matches that a geometry must explain, relative to its own matches."""
LEAST_MORE = 0.05
"""Smallest gain in held-out matches on their rows with which lens distortion is accepted."""
RADIALS = (0.0, -0.02, 0.02, -0.04, 0.04, -0.08, 0.08, -0.14, 0.14, -0.22)
"""Distortion coefficients to start from, as a fit from 0 misses strong ones. The first three detect distortion."""
FINE = 0.5
"""Share of the threshold used to compare distortions."""
MOST_RADIAL = 0.3
"""Largest plausible distortion coefficient of a lens."""
MOST_FITTED = 800
"""Largest number of matches that lenses are fitted to; more do not improve the fit."""
NEIGHBOURS, LEAST_LIKE = 8, 4
"""Nearest matches of a match, and how many must have a similar disparity for it to widen the range."""
STRAY = 0.5
"""Percentage of similar matches at either end that is dropped as stray."""
LIKE_PX, LIKE_SLOPE = 8.0, 0.1
"""Largest difference of similar disparities, in pixels, and its growth per pixel between the matches."""


class RectificationError(GeometryError):
    """An error for a pair whose rows do not correspond and cannot be aligned."""

    def __init__(self, message: str) -> None:
        super().__init__(f"cannot rectify: {message}; to match the rows as they are, leave rectification out")


class Rotation(NamedTuple):
    """Homographies of undistorted pictures, the distortion coefficients of their lenses, and the mask of inliers.

    Homographies and coefficients as (left, right).
    """

    homographies: tuple[np.ndarray, np.ndarray]
    radials: tuple[float, float]
    trusted: Bool[np.ndarray, "n"]
    plane: Plane | None = None
    """The dominant plane that explains the matches without parallax, so that the cameras' poses stay ambiguous."""

    def shifts(self, matches: Matches, shape: tuple[int, int]) -> Float64[np.ndarray, "n 2"]:
        """Return left minus right place (x, y) of matches in rectified pictures (h, w): disparity and row offset."""
        left, right = (
            transform(h, undistort(points, k, shape))
            for h, k, points in zip(self.homographies, self.radials, matches, strict=True)
        )
        return left - right


def threshold_px(shape: tuple[int, int]) -> float:
    """Return the largest distance of an inlier from its epipolar line or row, in pixels."""
    return max(1.0, max(shape) / 1500)


def find_rotation(matches: Matches, shape: tuple[int, int], fit: Fit) -> tuple[Rotation, str | None]:
    """Find the rectifying rotation of matches, and the reason not to trust it; None if it can be trusted.

    matches: without duplicates (`unique_matches`). Half of them determine a rotation that the other half validates,
    with and without lens distortion.
    Raises: RectificationError if no geometry explains the matches.
    """
    plain = _fit_rotation(matches, shape, fit)
    if (count := np.count_nonzero(plain.trusted)) < LEAST_TRUSTED:
        return plain, f"only {count} of {len(plain.trusted)} matches agree, {LEAST_TRUSTED} are needed"
    if (parts := _count_parts(matches.left_px[plain.trusted], shape)) < LEAST_PARTS:
        return (
            plain,
            f"the matches that agree lie in {parts} of {PARTS**2} parts of the picture, {LEAST_PARTS} are needed",
        )
    learnt, judges = (Matches(*(points[first::2] for points in matches)) for first in (0, 1))
    try:
        half = _fit_rotation(learnt, shape, fit)
    except RectificationError:
        return plain, "half of the matches contradict the rest"
    lenses = _fit_lenses(half, learnt, shape, fit)
    kept = max(_share_on_rows(each, judges, shape) for each in (half, lenses))
    if kept < LEAST_KEPT * np.mean(half.trusted):
        return plain, f"it explains {kept:.0%} of the held-out matches"
    near, better = (_share_on_rows(each, judges, shape, FINE) for each in (half, lenses))
    if better > (1 + LEAST_MORE) * near:
        return _fit_lenses(plain, matches, shape, fit), None
    return plain, None


def unique_matches(matches: Matches) -> Matches:
    """Remove duplicate matches, which could validate themselves."""
    _, first = np.unique(np.hstack(matches), axis=0, return_index=True)
    first = np.sort(first)
    return Matches(matches.left_px[first], matches.right_px[first])


def _fit_rotation(matches: Matches, shape: tuple[int, int], fit: Fit) -> Rotation:
    """Fit a rotation without lens distortion."""
    threshold = threshold_px(shape)
    try:
        found = robust_fundamental(*matches, threshold, fit)
    except DegenerateMatches as error:
        plane = best_plane(*matches, threshold) if error.reason == "homography" else None
        if plane is None:
            raise RectificationError(f"matches do not lie on their rows, and there is {error}") from error
        # The epipole is ambiguous: any that aligns the matches will do, and the nearest distorts least.
        homographies = aligning_homographies(_select(matches, plane.near), shape, None)
        return Rotation(homographies, (0.0, 0.0), plane.near, plane)
    roll = epipole_roll(found.matrix, shape)
    return Rotation(aligning_homographies(_select(matches, found.inliers), shape, roll), (0.0, 0.0), found.inliers)


def _select(matches: Matches, trusted: np.ndarray) -> Matches:
    return Matches(matches.left_px[trusted], matches.right_px[trusted])


def _fit_lenses(rotation: Rotation, matches: Matches, shape: tuple[int, int], fit: Fit) -> Rotation:
    """Return the rotation with lens distortion; unchanged if no distortion explains more of the matches."""
    few = Matches(*(points[:: 1 + len(points) // MOST_FITTED] for points in matches))
    radial = _best_radial(few, shape, fit)
    straight = Matches(*(undistort(points, radial, shape) for points in matches))
    try:
        found = robust_fundamental(*straight, threshold_px(shape), fit) if radial else None
    except DegenerateMatches:
        found = None
    if found is None:
        return rotation
    roll, trusted = epipole_roll(found.matrix, shape), found.inliers
    lenses = Rotation(rotation.homographies, (radial, radial), trusted)
    for _ in range(3):
        some = np.flatnonzero(trusted)[:: 1 + np.count_nonzero(trusted) // MOST_FITTED]
        lenses = Rotation(*aligning_lenses(_select(matches, some), shape, roll, lenses.radials), trusted)
        if max(map(abs, lenses.radials)) > MOST_RADIAL:
            return rotation
        trusted = np.abs(lenses.shifts(matches, shape)[:, 1]) <= threshold_px(shape)
        if np.count_nonzero(trusted) < np.count_nonzero(rotation.trusted) / 2:
            return rotation
    return lenses._replace(trusted=trusted)


def _best_radial(matches: Matches, shape: tuple[int, int], fit: Fit) -> float:
    """Return the coefficient of RADIALS that explains most matches; 0 if weak ones explain hardly more than 0."""
    none, *weak = (_count_explained(matches, each, shape, fit) for each in RADIALS[:3])
    if max(weak) <= (1 + LEAST_MORE) * none:
        return 0.0
    return max(RADIALS, key=lambda each: _count_explained(matches, each, shape, fit))


def _count_explained(matches: Matches, radial: float, shape: tuple[int, int], fit: Fit) -> int:
    """Count the inliers within FINE of the threshold if both lenses distort by `radial`."""
    straight = Matches(*(undistort(points, radial, shape) for points in matches))
    try:
        return int(np.count_nonzero(robust_fundamental(*straight, FINE * threshold_px(shape), fit).inliers))
    except DegenerateMatches:
        return 0


def verified_range(points_px: np.ndarray, disparity_px: np.ndarray) -> tuple[int, int]:
    """Return the lowest and highest disparity, except STRAY, of matches with similar neighbours; of all without any.

    points_px: (n, 2); disparity_px: (n,). A match on its row may still have a wrong column.
    """
    from scipy.spatial import KDTree

    away, nearest = KDTree(points_px).query(points_px, min(NEIGHBOURS + 1, len(points_px)))
    differing = np.abs(disparity_px[nearest] - disparity_px[:, None])
    like = np.count_nonzero(differing <= LIKE_PX + LIKE_SLOPE * away, axis=1) > LEAST_LIKE
    kept = disparity_px[like] if like.any() else disparity_px
    low, high = np.percentile(kept, [STRAY, 100 - STRAY])
    return int(np.floor(low)), int(np.ceil(high))


def _share_on_rows(rotation: Rotation, matches: Matches, shape: tuple[int, int], share: float = 1.0) -> float:
    """Return the share of the matches on their rows, within a share of the threshold."""
    return float(np.mean(np.abs(rotation.shifts(matches, shape)[:, 1]) <= share * threshold_px(shape)))


def _count_parts(points_px: np.ndarray, shape: tuple[int, int]) -> int:
    """Count the parts, of PARTS x PARTS parts of a picture, that contain points."""
    x, y = (points_px * PARTS // [shape[1], shape[0]]).astype(int).clip(0, PARTS - 1).T
    return len(np.unique(PARTS * y + x))
