"""Homographies that align the rows of two uncalibrated pictures and distort them as little as turning cameras does.

Each picture is turned about its camera's centre; unknown are two angles on the left, three on the right, and the two
focal lengths: seven numbers, as many as a fundamental matrix has. Focal lengths and angles stay near their usual
values unless the matches speak against them.
Source: Fusiello & Irsara, Quasi-Euclidean Epipolar Rectification of Uncalibrated Images, 2011; there one focal length.
"""

import numpy as np
from jaxtyping import Float64

from .epipolar import epipoles
from .homographies import camera_matrix, rotation, transform
from .matches import Matches

USUAL_FOCAL = 1.2
"""Focal length over the longer side of the picture: 45 degrees of view."""
_PRIOR = np.array([0.2, 0.5, 0.2, 0.2, 0.5, 0.5, 0.5])
"""Standard deviations about the start: left yaw, roll; right pitch, yaw, roll, in radians; logarithms of the focals."""
_NOISE_PX = 0.3


def aligning_homographies(
    fundamental: np.ndarray, matches: Matches, shape: tuple[int, int]
) -> tuple[Float64[np.ndarray, "3 3"], Float64[np.ndarray, "3 3"]]:
    """Homographies (left, right) that bring trusted matches onto common rows, left scale kept.

    The fundamental matrix gives the start: the direction of the left epipole.
    """
    from scipy.optimize import least_squares

    start = np.zeros(7)
    start[[1, 4]] = _epipole_roll(fundamental, shape)

    def cost(values: np.ndarray) -> np.ndarray:
        left, right = (transform(h, points) for h, points in zip(_pair(values, shape), matches, strict=True))
        offset = (left[:, 1] - right[:, 1]) / _NOISE_PX
        # A Cauchy-like pull: what MAGSAC let through by chance may not bend the geometry.
        return np.concatenate([np.sign(offset) * np.sqrt(np.log1p(offset**2)), (values - start) / _PRIOR])

    found = least_squares(cost, start, x_scale=_PRIOR * 0.1, max_nfev=200).x
    left, right = _pair(found, shape)
    if abs(found[1]) > np.pi / 4 and _runs_backwards(left, right, matches):
        turn = camera_matrix(1, shape) @ np.diag([-1.0, -1, 1]) @ np.linalg.inv(camera_matrix(1, shape))
        return turn @ left, turn @ right
    return left, right


def _epipole_roll(fundamental: np.ndarray, shape: tuple[int, int]) -> float:
    """The turn about the axis that lays the line from the picture's middle to the left epipole along the rows."""
    x, y, w = epipoles(fundamental)[0]
    direction = np.array([x - w * (shape[1] - 1) / 2, y - w * (shape[0] - 1) / 2])
    direction *= -1 if direction[0] < 0 else 1
    return -float(np.arctan2(direction[1], direction[0]))


def _pair(values: np.ndarray, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    usual = USUAL_FOCAL * max(shape)
    left_camera, right_camera = (camera_matrix(usual * np.exp(value), shape) for value in values[5:])
    return (
        left_camera @ rotation(0, *values[:2]) @ np.linalg.inv(left_camera),
        left_camera @ rotation(*values[2:5]) @ np.linalg.inv(right_camera),
    )


def _runs_backwards(left: np.ndarray, right: np.ndarray, matches: Matches) -> bool:
    """Whether near points shift to the wrong side, as when one camera stood above the other and was turned over."""
    shift = transform(left, matches.left_px)[:, 0] - transform(right, matches.right_px)[:, 0]
    return float(np.median(shift)) < 0
