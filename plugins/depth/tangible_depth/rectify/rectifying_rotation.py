"""The rectifying rotation of two pictures, which brings their matches onto common rows, and its evidence."""

from math import cos, exp, log, sin
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from tangible_core.errors import GeometryError

from ..sparse.matches import Matches
from .fundamental import DegenerateMatches, Fit, Fundamental, best_plane, robust_fundamental
from .least_squares import least_squares
from .projective import Plane, product, robust_pull, transform, undistort

# Fewest inliers of a trusted geometry: a few wrong matches agree on one by chance.
MIN_TRUSTED = 30
PARTS = 4
MIN_PARTS = 5  # fewest of the PARTS x PARTS parts that must contain inliers
# Lowest share of held-out matches that a geometry must explain, relative to its own matches.
MIN_KEPT = 0.5
MIN_MORE = 0.05  # smallest gain in held-out matches on their rows with which lens distortion is accepted
# Distortion coefficients to start from, as a fit from 0 misses strong ones. The first three detect distortion.
RADIALS = (0.0, -0.02, 0.02, -0.04, 0.04, -0.08, 0.08, -0.14, 0.14, -0.22)
FINE = 0.5  # share of the threshold used to compare distortions
MAX_RADIAL = 0.3
# Largest number of matches that lenses are fitted to; more do not improve the fit.
MAX_FITTED = 800
# Standard deviations of left roll and tilt; right roll, tilts along x and y, log scale and shift, about the start.
_PRIOR = np.array([0.5, 0.2, 0.5, 0.2, 0.2, 0.5, 0.5])
_RADIAL_PRIOR = np.array([0.1, 0.1])
# Step to which the start's roll is rounded, in radians, as linear algebra varies in its last bits by processor.
_START = 2.0**-10
_FOUND = 2.0**-20  # step to which the parameters are rounded, under a thousandth of a pixel
# Step to which sines and the like are rounded, as the C library varies in their last bits by processor.
_SINE = 2.0**-32
_STILL_PRIOR = np.array([1e-9, 1e-9, 0.5, 0.2, 0.2, 0.5, 0.5])


class RectificationError(GeometryError):
    """An error for a pair whose rows do not correspond and cannot be aligned."""

    def __init__(self, message: str) -> None:
        super().__init__(f"cannot rectify: {message}; to match the rows as they are, leave rectification out")


class Rotation(NamedTuple):
    """Homographies of undistorted pictures, their lenses' distortion (both left, right), and the mask of inliers."""

    homographies: tuple[np.ndarray, np.ndarray]
    radials: tuple[float, float]
    inliers: Bool[np.ndarray, "n"]
    # The dominant plane that explains the matches without parallax, so that the cameras' poses stay ambiguous.
    plane: Plane | None = None

    def shifts(self, matches: Matches, shape: tuple[int, int]) -> Float64[np.ndarray, "n 2"]:
        """Return left minus right place (x, y) of matches in rectified pictures (h, w): disparity and row offset."""
        left, right = (
            transform(h, undistort(points, k, shape))
            for h, k, points in zip(self.homographies, self.radials, matches, strict=True)
        )
        return left - right

    def on_rows(self, matches: Matches, shape: tuple[int, int], share: float = 1.0) -> Bool[np.ndarray, "n"]:
        """Find the matches on their rows, within a share of the threshold."""
        return np.abs(self.shifts(matches, shape)[:, 1]) <= share * threshold_px(shape)


def threshold_px(shape: tuple[int, int]) -> float:
    """Return the largest distance of an inlier from its epipolar line or row, in pixels."""
    return max(1.0, max(shape) / 1500)


def find_rotation(matches: Matches, shape: tuple[int, int], fit: Fit) -> tuple[Rotation, str | None]:
    """Find the rectifying rotation of unique matches, and the reason not to trust it. Raises: RectificationError."""
    plain = _fit_rotation(matches, shape, fit)
    if (count := np.count_nonzero(plain.inliers)) < MIN_TRUSTED:
        return plain, f"only {count} of {len(plain.inliers)} matches agree, {MIN_TRUSTED} are needed"
    if (parts := _count_parts(matches.left_px[plain.inliers], shape)) < MIN_PARTS:
        doubt = f"the matches that agree lie in {parts} of {PARTS**2} parts of the picture, {MIN_PARTS} are needed"
        return plain, doubt
    # Half of the matches determine a rotation that the other half validates, with and without lens distortion.
    learning, judges = (matches.select(slice(first, None, 2)) for first in (0, 1))
    try:
        half = _fit_rotation(learning, shape, fit)
    except RectificationError:
        return plain, "half of the matches contradict the rest"
    lenses = _fit_lenses(half, learning, shape, fit)
    explained = max(np.mean(rotation.on_rows(judges, shape)) for rotation in (half, lenses))
    if explained < MIN_KEPT * np.mean(half.inliers):
        return plain, f"it explains {explained:.0%} of the held-out matches"
    near, better = (np.mean(rotation.on_rows(judges, shape, FINE)) for rotation in (half, lenses))
    if better > (1 + MIN_MORE) * near:
        return _fit_lenses(plain, matches, shape, fit), None
    return plain, None


def _fit_rotation(matches: Matches, shape: tuple[int, int], fit: Fit) -> Rotation:
    threshold = threshold_px(shape)
    try:
        fundamental = robust_fundamental(matches, threshold, fit)
    except DegenerateMatches as error:
        plane = best_plane(matches, threshold) if error.reason == "homography" else None
        if plane is None:
            raise RectificationError(f"matches do not lie on their rows, and there is {error}") from error
        # The epipole is ambiguous: any that aligns the matches will do, and the nearest distorts least.
        homographies = aligning_homographies(matches.select(plane.near), shape, None)
        return Rotation(homographies, (0.0, 0.0), plane.near, plane)
    roll = epipole_roll(fundamental.matrix, shape)
    return Rotation(
        aligning_homographies(matches.select(fundamental.inliers), shape, roll), (0.0, 0.0), fundamental.inliers
    )


def _fit_lenses(rotation: Rotation, matches: Matches, shape: tuple[int, int], fit: Fit) -> Rotation:
    """Return the rotation with lens distortion; unchanged if no distortion explains more of the matches."""
    # Weak coefficients must explain clearly more than 0; then the one of RADIALS that explains most matches is fitted.
    few = matches.select(slice(None, None, 1 + len(matches.left_px) // MAX_FITTED))
    none, *weak = (_count_explained(few, radial, shape, fit) for radial in RADIALS[:3])
    if max(weak) <= (1 + MIN_MORE) * none:
        return rotation
    radial = max(RADIALS, key=lambda candidate: _count_explained(few, candidate, shape, fit))
    fundamental = _fit_straight(matches, radial, shape, threshold_px(shape), fit) if radial else None
    if fundamental is None:
        return rotation
    roll, inliers = epipole_roll(fundamental.matrix, shape), fundamental.inliers
    lenses = Rotation(rotation.homographies, (radial, radial), inliers)
    for _ in range(3):
        some = np.flatnonzero(inliers)[:: 1 + np.count_nonzero(inliers) // MAX_FITTED]
        lenses = Rotation(*aligning_lenses(matches.select(some), shape, roll, lenses.radials), inliers)
        if max(map(abs, lenses.radials)) > MAX_RADIAL:
            return rotation
        inliers = lenses.on_rows(matches, shape)
        if np.count_nonzero(inliers) < np.count_nonzero(rotation.inliers) / 2:
            return rotation
    return lenses._replace(inliers=inliers)


def _count_explained(matches: Matches, radial: float, shape: tuple[int, int], fit: Fit) -> int:
    fundamental = _fit_straight(matches, radial, shape, FINE * threshold_px(shape), fit)
    return 0 if fundamental is None else int(np.count_nonzero(fundamental.inliers))


def _fit_straight(
    matches: Matches, radial: float, shape: tuple[int, int], threshold: float, fit: Fit
) -> Fundamental | None:
    """Return F of the matches without the distortion of both lenses; None if they determine none."""
    straight = Matches(*(undistort(points, radial, shape) for points in matches))
    try:
        return robust_fundamental(straight, threshold, fit)
    except DegenerateMatches:
        return None


def _count_parts(points_px: np.ndarray, shape: tuple[int, int]) -> int:
    """Count the parts, of PARTS x PARTS parts of a picture, that contain points."""
    x, y = (points_px * PARTS // [shape[1], shape[0]]).astype(int).clip(0, PARTS - 1).T
    return len(np.unique(PARTS * y + x))


def aligning_homographies(
    matches: Matches, shape: tuple[int, int], roll: float | None = 0.0
) -> tuple[Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]]:
    """Return homographies (left, right) that bring trusted matches of pictures (h, w) onto common rows."""
    # The middle of each picture keeps its column. The left picture stays unchanged for a plane, which does not
    # determine its roll, and if its two parameters explain too little (Schwarz 1978): resampling would only blur it.
    still = _fit(matches, shape, 0.0, _STILL_PRIOR)
    if roll is None:
        return _homographies(still, matches, shape)
    free = _fit(matches, shape, roll, _PRIOR)
    costs = [_disagreement(_pair(parameters, shape), matches) for parameters in (free, still)]
    enough = costs[1] <= costs[0] + 2 * log(len(matches.left_px))
    return _homographies(still if enough else free, matches, shape)


def aligning_lenses(
    matches: Matches, shape: tuple[int, int], roll: float, radials: tuple[float, float]
) -> tuple[tuple[Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]], tuple[float, float]]:
    """Return homographies of undistorted points, and distortion coefficients, as (left, right); roll is a start."""
    parameters = _fit(matches, shape, roll, np.concatenate([_PRIOR, _RADIAL_PRIOR]), radials)
    left, right = float(parameters[7]), float(parameters[8])
    straight = Matches(undistort(matches.left_px, left, shape), undistort(matches.right_px, right, shape))
    return _homographies(parameters[:7], straight, shape), (left, right)


def _fit(
    matches: Matches, shape: tuple[int, int], roll: float, prior: np.ndarray, radials: tuple[float, ...] = ()
) -> np.ndarray:
    """Fit the seven parameters, and the lenses' coefficients if there is a prior for them."""
    start = np.array([*[0.0] * len(_PRIOR), *radials])
    start[[0, 2]] = _round_to(roll, _START)

    def cost(values: np.ndarray) -> np.ndarray:
        lenses = values[7:].tolist() or [0.0, 0.0]
        straight = (undistort(points, k, shape) for points, k in zip(matches, lenses, strict=True))
        left, right = (transform(h, points) for h, points in zip(_pair(values[:7], shape), straight, strict=True))
        return np.concatenate([robust_pull(left[:, 1] - right[:, 1]), (values - start) / prior])

    return np.array([_round_to(least_square, _FOUND) for least_square in least_squares(cost, start, prior)])


def _disagreement(pair: tuple[np.ndarray, np.ndarray], matches: Matches) -> float:
    left, right = (transform(h, points) for h, points in zip(pair, matches, strict=True))
    return float(np.square(robust_pull(left[:, 1] - right[:, 1])).sum())


def _homographies(
    parameters: np.ndarray, matches: Matches, shape: tuple[int, int]
) -> tuple[Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]]:
    left, right = _pair(parameters, shape)
    if abs(parameters[0]) > np.pi / 4:
        shift = transform(left, matches.left_px)[:, 0] - transform(right, matches.right_px)[:, 0]
        if np.median(shift) < 0:  # near points shift to the wrong side, as when one camera stood above the other
            # Both rotated by 180 degrees: parameters along the axes change their sign.
            left, right = _pair(parameters * [1, -1, 1, -1, -1, 1, -1] + np.pi * np.array([1, 0, 1, 0, 0, 0, 0]), shape)
    return left, right


def epipole_roll(fundamental: np.ndarray, shape: tuple[int, int]) -> float:
    """Return the rotation, in radians, that aligns the line from the middle to the left epipole with the rows."""
    x, y, w = epipoles(fundamental)[0]
    direction = np.array([x - w * (shape[1] - 1) / 2, y - w * (shape[0] - 1) / 2])
    direction *= -1 if direction[0] < 0 else 1
    return -float(np.arctan2(direction[1], direction[0]))


def epipoles(fundamental: np.ndarray) -> tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]:
    """Return the epipoles (left, right), homogeneous, of unit length: F^T left = 0 and F right = 0."""
    left, _, right = np.linalg.svd(fundamental)
    return left[:, 2], right[2]


def _pair(values: np.ndarray, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    left_roll, left_tilt, right_roll, right_tilt_x, right_tilt_y, log_scale, shift = values
    rows, columns = shape
    half = max(shape) / 2
    to_unit = np.array([[1 / half, 0, (1 - columns) / (2 * half)], [0, 1 / half, (1 - rows) / (2 * half)], [0, 0, 1]])
    left = _similarity_and_tilt(left_roll, (left_tilt, 0.0), 1.0, 0.0)
    right = _similarity_and_tilt(right_roll, (right_tilt_x, right_tilt_y), _round_to(exp(log_scale), _SINE), shift)
    back = np.array([[half, 0, (columns - 1) / 2], [0, half, (rows - 1) / 2], [0, 0, 1]])
    return product(product(back, left), to_unit), product(product(back, right), to_unit)


def _similarity_and_tilt(roll: float, tilt: tuple[float, float], scale: float, shift: float) -> np.ndarray:
    """Compose roll, scale, shift and a tilt along the rotated axes, so that it is independent of the cameras' roll."""
    across, down = (scale * _round_to(function(roll), _SINE) for function in (cos, sin))
    turn = np.array([[across, -down, 0], [down, across, 0], [0, 0, 1]])
    return product(np.array([[1, 0, 0], [0, 1, shift], [*tilt, 1]]), turn)


def _round_to(value: float, step: float) -> float:
    return round(value / step) * step
