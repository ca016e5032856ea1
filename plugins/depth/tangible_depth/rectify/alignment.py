"""Homographies that align the rows of two uncalibrated pictures and distort them as little as possible.

Each picture is rotated in its plane and tilted; the right one is also scaled and moved along its columns. About the
pictures' middles these are seven parameters, as many as a fundamental matrix has. Parameters that the matches hardly
determine stay near zero; shift and stretch along the rows, which the matches do not determine, are left out. If the
lenses distort, one coefficient for each is estimated along with the seven.
Source: the split into similarity and perspective is that of Loop & Zhang, Computing Rectifying Homographies for
Stereo Vision, CVPR 1999; fitting to the matches that of Hartley, Theory and Practice of Projective Rectification, 1999.
"""

from math import cos, exp, log, sin

import numpy as np
from jaxtyping import Float64

from ..sparse.matches import Matches
from .least_squares import least_squares, robust_pull
from .projective import epipoles, product, transform, undistort

_PRIOR = np.array([0.5, 0.2, 0.5, 0.2, 0.2, 0.5, 0.5])
"""Standard deviations of the parameters about the start: left roll and tilt along x; right roll, tilts along x and y,
logarithm of scale, shift along y. Rolls in radians, lengths in half the longer side of the picture, tilts in its
inverse."""
_RADIAL_PRIOR = np.array([0.1, 0.1])
"""Standard deviations of the distortion coefficients of both lenses."""
_START = 2.0**-10
"""Step to which the start's roll is rounded, in radians, as linear algebra varies in its last bits by processor."""
_FOUND = 2.0**-20
"""Step to which the parameters are rounded, under a thousandth of a pixel."""
_SINE = 2.0**-32
"""Step to which sines and the like are rounded, as the C library varies in their last bits by processor."""
_STILL_PRIOR = np.array([1e-9, 1e-9, 0.5, 0.2, 0.2, 0.5, 0.5])
"""Standard deviations of the parameters if the left picture stays unchanged."""


def aligning_homographies(
    matches: Matches, shape: tuple[int, int], roll: float | None = 0.0
) -> tuple[Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]]:
    """Return homographies (left, right), each (3, 3), that bring trusted matches of pictures (h, w) onto common rows.

    The middle of each picture keeps its column: a disparity is the shift against the right picture rotated about its
    middle. roll: start value in radians, see `epipole_roll`; None for a plane, which does not determine it. The left
    picture then stays unchanged, as it does if its two parameters explain too little: resampling would only blur it.
    Source of how much is too little: Schwarz, Estimating the Dimension of a Model, Annals of Statistics 1978.
    """
    still = _fit(matches, shape, 0.0, _STILL_PRIOR)
    if roll is None:
        return _homographies(still, matches, shape)
    free = _fit(matches, shape, roll, _PRIOR)
    costs = [_disagreement(_pair(found, shape), matches) for found in (free, still)]
    enough = costs[1] <= costs[0] + 2 * log(len(matches.left_px))
    return _homographies(still if enough else free, matches, shape)


def aligning_lenses(
    matches: Matches, shape: tuple[int, int], roll: float, radials: tuple[float, float]
) -> tuple[tuple[Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]], tuple[float, float]]:
    """Return homographies of undistorted points, and the distortion coefficients, each as (left, right).

    As `aligning_homographies`, for pictures with lens distortion. roll, radials: start values.
    """
    found = _fit(matches, shape, roll, np.concatenate([_PRIOR, _RADIAL_PRIOR]), radials)
    left, right = float(found[7]), float(found[8])
    straight = Matches(undistort(matches.left_px, left, shape), undistort(matches.right_px, right, shape))
    return _homographies(found[:7], straight, shape), (left, right)


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

    return np.array([_round_to(each, _FOUND) for each in least_squares(cost, start, prior)])


def _disagreement(pair: tuple[np.ndarray, np.ndarray], matches: Matches) -> float:
    """Return the sum of the squared robust offsets of the matches from their rows."""
    left, right = (transform(h, points) for h, points in zip(pair, matches, strict=True))
    return float(np.square(robust_pull(left[:, 1] - right[:, 1])).sum())


def _homographies(
    found: np.ndarray, matches: Matches, shape: tuple[int, int]
) -> tuple[Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]]:
    left, right = _pair(found, shape)
    if abs(found[0]) > np.pi / 4 and _runs_backwards(left, right, matches):
        # Both rotated by 180 degrees: parameters along the axes change their sign.
        left, right = _pair(found * [1, -1, 1, -1, -1, 1, -1] + np.pi * np.array([1, 0, 1, 0, 0, 0, 0]), shape)
    return left, right


def epipole_roll(fundamental: np.ndarray, shape: tuple[int, int]) -> float:
    """Return the rotation, in radians, that aligns the line from the middle to the left epipole with the rows."""
    x, y, w = epipoles(fundamental)[0]
    direction = np.array([x - w * (shape[1] - 1) / 2, y - w * (shape[0] - 1) / 2])
    direction *= -1 if direction[0] < 0 else 1
    return -float(np.arctan2(direction[1], direction[0]))


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


def _runs_backwards(left: np.ndarray, right: np.ndarray, matches: Matches) -> bool:
    """Test whether near points shift to the wrong side, as when one camera stood above the other."""
    shift = transform(left, matches.left_px)[:, 0] - transform(right, matches.right_px)[:, 0]
    return float(np.median(shift)) < 0
