"""How two pictures are to be turned so that their matches lie on common rows, and whether to believe it."""

import logging
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from tangible_core.errors import GeometryError

from ..sparse.matches import Matches
from .alignment import aligning_homographies, aligning_lenses, epipole_roll
from .fundamental import DegenerateMatches, Fit, robust_fundamental
from .homographies import transform
from .lenses import undistorted
from .parallax import Plane, best_plane

logger = logging.getLogger(__name__)

LEAST_TRUSTED = 30
"""Matches that agree on a geometry below which it is not believed: a few wrong ones agree on one by chance."""
PARTS, LEAST_PARTS = 4, 5
"""The left picture in PARTS x PARTS: in how many of these trusted matches must lie."""
LEAST_KEPT = 0.5
"""Of matches that had no part in it a geometry must explain this share of what it explains of its own."""
LEAST_MORE = 0.05
"""Share of further matches that distortion must bring onto their rows, of those that had no part in it."""
RADIALS = (0.0, -0.02, 0.02, -0.04, 0.04, -0.08, 0.08, -0.14, 0.14, -0.22)
"""Distortions to start from: from none, a fit of strong ones goes astray. The first three tell whether there is any."""
FINE = 0.5
"""Share of the threshold by which they are told apart."""
MOST_RADIAL = 0.3
"""A lens that distorts by more is none that people put before a camera: something else bends the matches."""
MOST_FITTED = 800
"""Matches that lenses are fitted to: more tell no more."""


NEIGHBOURS, LEAST_LIKE = 8, 4
"""Of its nearest NEIGHBOURS, how many must have a disparity like that of a match that is to widen the range."""
STRAY = 0.5
"""Percent of those at either end that stray all the same."""
LIKE_PX, LIKE_SLOPE = 8.0, 0.1
"""How far apart like disparities may be: in pixels, and per pixel between the two matches."""


class RectificationError(GeometryError):
    """A pair whose rows do not correspond and that cannot be turned so that they do."""

    def __init__(self, message: str) -> None:
        super().__init__(f"cannot rectify: {message}; to match the rows as they are, leave rectification out")


class Turn(NamedTuple):
    """Homographies of pictures without distortion, the distortion of their lenses, and which matches they explain.

    Both as (left, right).
    """

    homographies: tuple[np.ndarray, np.ndarray]
    radials: tuple[float, float]
    trusted: Bool[np.ndarray, "n"]
    plane: Plane | None = None
    """What explains them without parallax, which leaves open how the cameras stood."""

    def shifts(self, matches: Matches, shape: tuple[int, int]) -> Float64[np.ndarray, "n 2"]:
        """Of matches in pictures (h, w), left less right place (x, y) once they are turned: disparity, row offset."""
        left, right = (
            transform(h, undistorted(points, k, shape))
            for h, k, points in zip(self.homographies, self.radials, matches, strict=True)
        )
        return left - right


def threshold_px(shape: tuple[int, int]) -> float:
    """Distance from its epipolar line, or from its row, up to which a match is right."""
    return max(1.0, max(shape) / 1500)


def find_turn(matches: Matches, shape: tuple[int, int], fit: Fit) -> tuple[Turn, str | None]:
    """The turn that the matches call for, and why it cannot be believed; None if it can.

    matches: each once (`different`). Half of them make a turn that the other half judges, with and without
    distortion of the lenses.
    Raises: RectificationError if no geometry explains the matches.
    """
    plain = _turn(matches, shape, fit)
    if (count := np.count_nonzero(plain.trusted)) < LEAST_TRUSTED:
        return plain, f"only {count} of {len(plain.trusted)} matches agree, {LEAST_TRUSTED} are needed"
    if (parts := _parts(matches.left_px[plain.trusted], shape)) < LEAST_PARTS:
        return (
            plain,
            f"the matches that agree lie in {parts} of {PARTS**2} parts of the picture, {LEAST_PARTS} are needed",
        )
    learnt, judges = (Matches(*(points[first::2] for points in matches)) for first in (0, 1))
    try:
        half = _turn(learnt, shape, fit)
    except RectificationError:
        return plain, "half of the matches do not tell what all of them do"
    lenses = _with_lenses(half, learnt, shape, fit)
    kept = max(_on_rows(each, judges, shape) for each in (half, lenses))
    if kept < LEAST_KEPT * np.mean(half.trusted):
        return plain, f"it explains {kept:.0%} of the matches that had no part in it"
    near, better = (_on_rows(each, judges, shape, FINE) for each in (half, lenses))
    if better > (1 + LEAST_MORE) * near:
        return _with_lenses(plain, matches, shape, fit), None
    return plain, None


def different(matches: Matches) -> Matches:
    """Each match once: one that stands among its own judges says nothing."""
    _, first = np.unique(np.hstack(matches), axis=0, return_index=True)
    first = np.sort(first)
    return Matches(matches.left_px[first], matches.right_px[first])


def _turn(matches: Matches, shape: tuple[int, int], fit: Fit) -> Turn:
    """Without distortion of the lenses."""
    threshold = threshold_px(shape)
    try:
        found = robust_fundamental(*matches, threshold, fit)
    except DegenerateMatches as error:
        plane = best_plane(*matches, threshold) if error.reason == "homography" else None
        if plane is None:
            raise RectificationError(f"matches do not lie on their rows, and there is {error}") from error
        # The epipole is open: any that aligns the matches will do, and the nearest bends least.
        homographies = aligning_homographies(_kept(matches, plane.near), shape, None)
        return Turn(homographies, (0.0, 0.0), plane.near, plane)
    roll = epipole_roll(found.matrix, shape)
    return Turn(aligning_homographies(_kept(matches, found.inliers), shape, roll), (0.0, 0.0), found.inliers)


def _kept(matches: Matches, trusted: np.ndarray) -> Matches:
    return Matches(matches.left_px[trusted], matches.right_px[trusted])


def _with_lenses(turn: Turn, matches: Matches, shape: tuple[int, int], fit: Fit) -> Turn:
    """The turn with distortion of the lenses; as it is where none explains more of the matches."""
    few = Matches(*(points[:: 1 + len(points) // MOST_FITTED] for points in matches))
    radial = _radial(few, shape, fit)
    straight = Matches(*(undistorted(points, radial, shape) for points in matches))
    try:
        found = robust_fundamental(*straight, threshold_px(shape), fit) if radial else None
    except DegenerateMatches:
        found = None
    if found is None:
        return turn
    roll, trusted = epipole_roll(found.matrix, shape), found.inliers
    lenses = Turn(turn.homographies, (radial, radial), trusted)
    for _ in range(3):
        some = np.flatnonzero(trusted)[:: 1 + np.count_nonzero(trusted) // MOST_FITTED]
        lenses = Turn(*aligning_lenses(_kept(matches, some), shape, roll, lenses.radials), trusted)
        if max(map(abs, lenses.radials)) > MOST_RADIAL:
            return turn
        trusted = np.abs(lenses.shifts(matches, shape)[:, 1]) <= threshold_px(shape)
        if np.count_nonzero(trusted) < np.count_nonzero(turn.trusted) / 2:
            return turn
    return lenses._replace(trusted=trusted)


def _radial(matches: Matches, shape: tuple[int, int], fit: Fit) -> float:
    """Of RADIALS that which explains most matches; none where weak ones explain hardly more than none does."""
    none, *weak = (_explained(matches, each, shape, fit) for each in RADIALS[:3])
    if max(weak) <= (1 + LEAST_MORE) * none:
        return 0.0
    return max(RADIALS, key=lambda each: _explained(matches, each, shape, fit))


def _explained(matches: Matches, radial: float, shape: tuple[int, int], fit: Fit) -> int:
    """How many matches one geometry explains to a fraction of the threshold, where both lenses distort by `radial`."""
    straight = Matches(*(undistorted(points, radial, shape) for points in matches))
    try:
        return int(np.count_nonzero(robust_fundamental(*straight, FINE * threshold_px(shape), fit).inliers))
    except DegenerateMatches:
        return 0


def seen_range(points_px: np.ndarray, disparity_px: np.ndarray) -> tuple[int, int]:
    """Lowest and highest disparity, but for STRAY, of matches (n, 2), (n,) with neighbours like them; of all if none.

    What lies on its row may still be matched to a wrong column.
    """
    from scipy.spatial import KDTree

    away, nearest = KDTree(points_px).query(points_px, min(NEIGHBOURS + 1, len(points_px)))
    differing = np.abs(disparity_px[nearest] - disparity_px[:, None])
    like = np.count_nonzero(differing <= LIKE_PX + LIKE_SLOPE * away, axis=1) > LEAST_LIKE
    kept = disparity_px[like] if like.any() else disparity_px
    low, high = np.percentile(kept, [STRAY, 100 - STRAY])
    return int(np.floor(low)), int(np.ceil(high))


def _on_rows(turn: Turn, matches: Matches, shape: tuple[int, int], share: float = 1.0) -> float:
    """Share of the matches that lie on their rows, to a share of the threshold."""
    return float(np.mean(np.abs(turn.shifts(matches, shape)[:, 1]) <= share * threshold_px(shape)))


def _parts(points_px: np.ndarray, shape: tuple[int, int]) -> int:
    """In how many of PARTS x PARTS parts of a picture there are points."""
    x, y = (points_px * PARTS // [shape[1], shape[0]]).astype(int).clip(0, PARTS - 1).T
    return len(np.unique(PARTS * y + x))
