"""Epipolar geometry of two pictures: lines, epipoles, and the distance of a match from a fundamental matrix.

Convention: left^T F right = 0, points homogeneous (column, row, 1) in pixels. A right point's line in the left
picture is F right, a left point's line in the right picture is F^T left.
"""

import numpy as np
from jaxtyping import Float64


def homogeneous(points_px: np.ndarray) -> Float64[np.ndarray, "n 3"]:
    """Append a third coordinate of one to points (n, 2)."""
    return np.column_stack([np.asarray(points_px, np.float64), np.ones(len(points_px))])


def product(one: np.ndarray, other: np.ndarray) -> Float64[np.ndarray, "n m"]:
    """Multiply one (n, k) by other (k, m), summing in the same order on every processor, unlike BLAS."""
    return np.einsum("nk,km->nm", one, other)


def lines_in_left(fundamental: np.ndarray, right_px: np.ndarray) -> Float64[np.ndarray, "n 3"]:
    """Return epipolar lines a x + b y + c = 0 in the left picture, one per right point (n, 2), with a^2 + b^2 = 1.

    The distance of a left point from its line is then |a x + b y + c| in pixels. The epipole has no line: its row is
    NaN.
    Source: Hartley & Zisserman, Multiple View Geometry, 2nd ed., sec. 9.2.
    """
    return _unit_normal(product(homogeneous(right_px), fundamental.T))


def _unit_normal(lines: np.ndarray) -> Float64[np.ndarray, "n 3"]:
    length = np.hypot(lines[:, 0], lines[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(length[:, None] > 0, lines / length[:, None], np.nan)


def epipoles(fundamental: np.ndarray) -> tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]:
    """Return the epipoles (left, right), each camera's centre in the other view: homogeneous, of unit length.

    F^T left_epipole = 0 and F right_epipole = 0. A third coordinate of zero means infinitely far, as in a rectified
    pair, where both are (1, 0, 0).
    """
    left, _, right = np.linalg.svd(fundamental)
    return left[:, 2], right[2]


def segments(lines: np.ndarray, shape: tuple[int, int]) -> Float64[np.ndarray, "n 4"]:
    """Return ends (x0, y0, x1, y1) of the part of each line in a picture of shape (h, w), NaN without one."""
    rows, columns = shape
    a, b, c = (np.asarray(lines, np.float64)[:, i : i + 1] for i in range(3))
    right, bottom = columns - 1.0, rows - 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        xs = np.hstack([np.zeros_like(a), np.full_like(a, right), -c / a, -(b * bottom + c) / a])
        ys = np.hstack([-c / b, -(a * right + c) / b, np.zeros_like(a), np.full_like(a, bottom)])
        inside = (xs >= -1e-9) & (xs <= right + 1e-9) & (ys >= -1e-9) & (ys <= bottom + 1e-9)
    along = np.where(inside, -b * xs + a * ys, np.nan)
    row = np.arange(len(a))
    first = np.argmin(np.where(inside, along, np.inf), axis=1)
    last = np.argmax(np.where(inside, along, -np.inf), axis=1)
    ends = np.column_stack([xs[row, first], ys[row, first], xs[row, last], ys[row, last]])
    return np.where(inside.any(axis=1, keepdims=True), ends, np.nan)


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
