"""Projective geometry of two pictures: matches and lines, homographies of rotating cameras, and lens distortion.

Convention: left^T F right = 0, points homogeneous (column, row, 1) in pixels. A right point's line in the left
picture is F right, a left point's line in the right picture is F^T left. A camera that rotates about its centre moves
points by H = K R K^-1.

A point at radius r from the picture's middle, in half its longer side, is at r (1 + k / 2) / (1 + k r^2) in the picture
of a lens without distortion: k < 0 where straight lines bulge outwards. The factor keeps the size of the picture as a
whole; without it a fit would shrink the picture.
Sources: Hartley & Zisserman, Multiple View Geometry, 2nd ed., sec. 8.4.2 and ch. 9; Fitzgibbon, Simultaneous linear
estimation of multiple view geometry and lens distortion, CVPR 2001.
"""

import numpy as np
from jaxtyping import Float64


def homogeneous(points_px: np.ndarray) -> Float64[np.ndarray, "n 3"]:
    """Append a third coordinate of one to points (n, 2)."""
    return np.column_stack([np.asarray(points_px, np.float64), np.ones(len(points_px))])


def product(one: np.ndarray, other: np.ndarray) -> Float64[np.ndarray, "n m"]:
    """Multiply one (n, k) by other (k, m), summing in the same order on every processor, unlike BLAS."""
    return np.einsum("nk,km->nm", one, other)


def epipoles(fundamental: np.ndarray) -> tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]:
    """Return the epipoles (left, right), each camera's centre in the other view: homogeneous, of unit length.

    F^T left_epipole = 0 and F right_epipole = 0. A third coordinate of zero means infinitely far, as in a rectified
    pair, where both are (1, 0, 0).
    """
    left, _, right = np.linalg.svd(fundamental)
    return left[:, 2], right[2]


def sampson_distance(fundamental: np.ndarray, left_px: np.ndarray, right_px: np.ndarray) -> Float64[np.ndarray, "n"]:
    """Return the first-order distance in pixels of each match (n, 2), (n, 2) from the nearest pair that obeys F.

    |l^T F r| / sqrt((F r)_1^2 + (F r)_2^2 + (F^T l)_1^2 + (F^T l)_2^2).
    Source: the root of Hartley & Zisserman, 2nd ed., eq. 11.9.
    """
    left, right = homogeneous(left_px), homogeneous(right_px)
    in_left, in_right = product(right, fundamental.T), product(left, fundamental)
    value = np.einsum("ni,ni->n", left, in_left)
    normals = [np.einsum("ni,ni->n", each[:, :2], each[:, :2]) for each in (in_left, in_right)]
    return np.abs(value) / np.sqrt(np.maximum(normals[0] + normals[1], np.finfo(np.float64).tiny))


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
