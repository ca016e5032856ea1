"""The radial distortion of a lens, in one coefficient.

A point at radius r from the picture's middle, in half its longer side, is at r (1 + k / 2) / (1 + k r^2) in the picture
of a lens without distortion: k < 0 where straight lines bulge outwards. The factor keeps the size of the picture as a
whole; without it a fit would shrink the picture.
Source: Fitzgibbon, Simultaneous linear estimation of multiple view geometry and lens distortion, CVPR 2001.
"""

import numpy as np
from jaxtyping import Float64


def undistort(points_px: np.ndarray, radial: float, shape: tuple[int, int]) -> Float64[np.ndarray, "n 2"]:
    """Map points (n, 2) of a picture (h, w) to the picture of a lens without distortion."""
    if radial == 0:
        return np.asarray(points_px, np.float64)
    middle, half = _frame(shape)
    away = (points_px - middle) / half
    return middle + half * away * (1 + radial / 2) / (1 + radial * _square(away))


def distort(points_px: np.ndarray, radial: float, shape: tuple[int, int]) -> Float64[np.ndarray, "n 2"]:
    """Invert `undistort`; a point that has no inverse is mapped far outside of the picture."""
    if radial == 0:
        return np.asarray(points_px, np.float64)
    middle, half = _frame(shape)
    away = (points_px - middle) / (half * (1 + radial / 2))
    return middle + half * away * 2 / (1 + np.sqrt(np.maximum(1 - 4 * radial * _square(away), 0)))


def _frame(shape: tuple[int, int]) -> tuple[np.ndarray, float]:
    rows, columns = shape
    return np.array([(columns - 1) / 2, (rows - 1) / 2]), max(shape) / 2


def _square(away: np.ndarray) -> np.ndarray:
    return away[:, :1] ** 2 + away[:, 1:] ** 2
