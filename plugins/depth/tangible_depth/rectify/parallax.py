"""Dominant planes: matches that one homography explains, the parallax of the others, and purely rotated cameras.

Convention: left^T F right = 0 (see `projective`); homographies lead from the right picture to the left one.
"""

from math import exp, log
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from .least_squares import least_squares, robust_pull
from .projective import camera_matrix, homogeneous, inverse, product, rotation, transform

MOST_SAMPLED = 100
"""Largest number of matches off a plane whose pairs are tried for an epipole."""
FOCAL_SPREAD, ZOOM_SPREAD, TURN_SPREAD = 0.35, 0.2, 0.5
"""Standard deviations of the parameters of an unknown camera: logarithm of its focal length in longer sides of the
picture, logarithm of the zoom between the pictures, and each angle in radians."""
FREE_NUMBERS = 3
"""Degrees of freedom of a homography beyond those of a rotating, zooming camera of unknown focal length: 8 - 5."""


class Plane(NamedTuple):
    """The best homography (3, 3), and the mask of matches within three thresholds of it."""

    matrix: Float64[np.ndarray, "3 3"]
    near: Bool[np.ndarray, "n"]


def best_plane(left_px: np.ndarray, right_px: np.ndarray, threshold_px: float) -> Plane | None:
    """Find the homography that explains most matches (n, 2), (n, 2); None without one."""
    import cv2

    matrix, _ = cv2.findHomography(right_px, left_px, cv2.USAC_MAGSAC, 2 * threshold_px)
    if matrix is None:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.linalg.norm(transform(matrix, right_px) - left_px, axis=1)
    return Plane(matrix, away <= 3 * threshold_px)


def fundamental_from_plane(
    plane: Plane, left_px: np.ndarray, right_px: np.ndarray, threshold_px: float
) -> Float64[np.ndarray, "3 3"] | None:
    """Return F = [e]x H with the epipole e of most matches off the plane; None with fewer than two of them.

    Two matches off the plane determine an epipole; a sample of seven would seldom contain two of a small object.
    Source: Chum, Werner & Matas, Two-View Geometry Estimation Unaffected by a Dominant Plane, CVPR 2005.
    """
    off = np.flatnonzero(~plane.near)
    left, moved = homogeneous(left_px[off]), homogeneous(transform(plane.matrix, right_px[off]))
    lines = np.cross(moved, left)
    some = np.arange(len(off))[:: 1 + len(off) // MOST_SAMPLED]
    one, other = (some[each] for each in np.triu_indices(len(some), 1))
    epipoles = np.cross(lines[one], lines[other])
    length = np.linalg.norm(epipoles, axis=1)
    epipoles = epipoles[length > 0] / length[length > 0, None]
    if not len(epipoles):
        return None
    across = [epipoles[:, i, None] * moved[:, 2] - epipoles[:, 2, None] * moved[:, i] for i in (0, 1)]
    agreeing = np.abs(product(epipoles, lines.T)) <= threshold_px * np.hypot(*across)
    x, y, w = epipoles[np.count_nonzero(agreeing, axis=1).argmax()]
    return product(np.array([[0, -w, y], [w, 0, -x], [-y, x, 0]]), plane.matrix)


def is_pure_rotation(plane: Plane, left_px: np.ndarray, right_px: np.ndarray, shape: tuple[int, int]) -> bool:
    """Test whether a camera that rotated about its centre, and perhaps zoomed, explains the matches as well as a plane.

    H = K R K'^-1 with a plausible focal length. A wall seen from two places does not fit: it is shifted, stretched
    along the baseline or sheared, which no rotation does.
    Source: Hartley & Zisserman, Multiple View Geometry, 2nd ed., sec. 8.4.2; Schwarz, Estimating the Dimension of a
    Model, Annals of Statistics 1978, for how much three more parameters must explain.
    """
    left, right = left_px[plane.near], right_px[plane.near]
    spread = np.array([FOCAL_SPREAD, ZOOM_SPREAD, TURN_SPREAD, TURN_SPREAD, TURN_SPREAD])

    def cost(values: np.ndarray) -> np.ndarray:
        away = transform(_rotation_homography(values, shape), right) - left
        return np.concatenate([robust_pull(away.ravel()), values / spread])

    turned = np.square(cost(least_squares(cost, np.zeros(5), spread))).sum()
    flat = np.square(robust_pull((transform(plane.matrix, right) - left).ravel())).sum()
    return bool(turned <= flat + FREE_NUMBERS * log(len(left)))


def _rotation_homography(values: np.ndarray, shape: tuple[int, int]) -> Float64[np.ndarray, "3 3"]:
    """Return the homography from right to left for log focal length, log zoom, pitch, yaw and roll."""
    focal_px = max(shape) * exp(values[0])
    right = camera_matrix(focal_px * exp(values[1]), shape)
    return product(product(camera_matrix(focal_px, shape), rotation(*values[2:])), inverse(right))
