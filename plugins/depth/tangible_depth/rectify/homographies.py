"""Homographies of a camera that rotates about its centre: H = K R K^-1.

Source: Hartley & Zisserman, Multiple View Geometry, 2nd ed., sec. 8.4.2.
"""

import numpy as np
from jaxtyping import Float64

from .epipolar import homogeneous, product


def transform(homography: np.ndarray, points_px: np.ndarray) -> Float64[np.ndarray, "n 2"]:
    """Map points (n, 2) by a homography (3, 3)."""
    moved = product(homogeneous(points_px), homography.T)
    return moved[:, :2] / moved[:, 2:]


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
