"""Projective geometry of two pictures, left^T F right = 0: homographies, rotating cameras, lens distortion."""

from math import exp, log
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from ..sparse.matches import Matches
from .least_squares import least_squares, robust_pull

FOCAL_SPREAD, ZOOM_SPREAD, TURN_SPREAD = 0.35, 0.2, 0.5
"""Standard deviations of the log focal length in longer sides, of the log zoom, and of each angle in radians."""
# Degrees of freedom of a homography beyond those of a rotating, zooming camera of unknown focal length: 8 - 5.
FREE_NUMBERS = 3


def homogeneous(points_px: np.ndarray) -> Float64[np.ndarray, "n 3"]:
    """Append a third coordinate of one to points (n, 2)."""
    return np.column_stack([np.asarray(points_px, np.float64), np.ones(len(points_px))])


def product(one: np.ndarray, other: np.ndarray) -> Float64[np.ndarray, "n m"]:
    """Multiply one (n, k) by other (k, m), summing in the same order on every processor, unlike BLAS."""
    return np.einsum("nk,km->nm", one, other)


def transform(homography: np.ndarray, points_px: np.ndarray) -> Float64[np.ndarray, "n 2"]:
    """Map points (n, 2) by a homography (3, 3)."""
    points = product(homogeneous(points_px), homography.T)
    return points[:, :2] / points[:, 2:]


def inverse(matrix: np.ndarray) -> Float64[np.ndarray, "3 3"]:
    """Invert a matrix (3, 3) by its cofactors."""
    cofactors = np.cross(np.roll(matrix, -1, axis=0), np.roll(matrix, -2, axis=0))
    return cofactors.T / (matrix[0] * cofactors[0]).sum()


def rotation(pitch: float, yaw: float, roll: float) -> Float64[np.ndarray, "3 3"]:
    """Return R_z(roll) R_y(yaw) R_x(pitch), angles in radians."""
    (cx, cy, cz), (sx, sy, sz) = np.cos([pitch, yaw, roll]), np.sin([pitch, yaw, roll])
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1.0]])
    return product(product(about_z, about_y), about_x)


def camera_matrix(focal_px: float, shape: tuple[int, int]) -> Float64[np.ndarray, "3 3"]:
    """Return K of a camera whose axis goes through the middle of a picture (h, w)."""
    rows, columns = shape
    return np.array([[focal_px, 0, (columns - 1) / 2], [0, focal_px, (rows - 1) / 2], [0, 0, 1.0]])


def undistort(points_px: np.ndarray, radial: float, shape: tuple[int, int]) -> Float64[np.ndarray, "n 2"]:
    """Map points (n, 2) of a picture (h, w) to the picture of a lens without distortion."""
    if radial == 0:
        return np.asarray(points_px, np.float64)
    # Radius r, in half longer sides, becomes r (1 + k / 2) / (1 + k r^2), k < 0 where lines bulge outwards (Fitzgibbon,
    # CVPR 2001). The factor keeps the size of the picture as a whole; without it a fit would shrink the picture.
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


class Plane(NamedTuple):
    """The best homography (3, 3), and the mask of matches within three thresholds of it."""

    matrix: Float64[np.ndarray, "3 3"]
    near: Bool[np.ndarray, "n"]


def is_pure_rotation(plane: Plane, matches: Matches, shape: tuple[int, int]) -> bool:
    """Test whether a camera that rotated and perhaps zoomed explains the matches as well as a plane."""
    # H = K R K'^-1 with a plausible focal length (Hartley & Zisserman, 2nd ed., sec. 8.4.2). A wall seen from two
    # places is shifted, stretched along the baseline or sheared, which no rotation does. How much three more parameters
    # must explain: Schwarz, Estimating the Dimension of a Model, Annals of Statistics 1978.
    left, right = matches.select(plane.near)
    spread = np.array([FOCAL_SPREAD, ZOOM_SPREAD, TURN_SPREAD, TURN_SPREAD, TURN_SPREAD])

    def cost(values: np.ndarray) -> np.ndarray:
        """values: log focal length, log zoom, pitch, yaw and roll."""
        focal_px = max(shape) * exp(values[0])
        of_left, of_right = camera_matrix(focal_px, shape), camera_matrix(focal_px * exp(values[1]), shape)
        away = transform(product(product(of_left, rotation(*values[2:])), inverse(of_right)), right) - left
        return np.concatenate([robust_pull(away.ravel()), values / spread])

    rotation_cost = np.square(cost(least_squares(cost, np.zeros(5), spread))).sum()
    plane_cost = np.square(robust_pull((transform(plane.matrix, right) - left).ravel())).sum()
    return bool(rotation_cost <= plane_cost + FREE_NUMBERS * log(len(left)))
