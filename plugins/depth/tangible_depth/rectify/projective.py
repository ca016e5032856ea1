"""Projective geometry of two pictures, left^T F right = 0: homographies, rotating cameras, lenses, rectified pairs."""

from dataclasses import dataclass, replace
from math import exp, log
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64

from tangible_core.data import DisparityMap, Record, Views
from tangible_core.errors import PictureError
from tangible_core.runtime import plain_opencv

from ..sparse.matches import Matches
from .least_squares import least_squares

FOCAL_SPREAD, ZOOM_SPREAD, TURN_SPREAD = 0.35, 0.2, 0.5
"""Standard deviations of the log focal length in longer sides, of the log zoom, and of each angle in radians."""
# Degrees of freedom of a homography beyond those of a rotating, zooming camera of unknown focal length: 8 - 5.
FREE_NUMBERS = 3
NOISE_PX = 0.3  # standard deviation of a coordinate of a match, in pixels
_LOG_2 = 0.6931471805599453


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


def robust_pull(offset_px: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
    """Return the root of log(1 + (offset / NOISE_PX)^2), with the offset's sign: outliers hardly affect the fit."""
    offset = offset_px / NOISE_PX
    return np.sign(offset) * np.sqrt(_log1p(offset * offset))


def _log1p(values: np.ndarray) -> np.ndarray:
    """Compute log(1 + x) for x >= 0 by multiplications and additions alone: the C library's differs by processor."""
    # 2 atanh(x / (2 + x)), for large x of the fraction of 1 + x and with log 2 for each power of two.
    fraction, power = np.frexp(1 + values)
    small = values < 1
    share = np.where(small, values / (2 + values), (fraction - 1) / (fraction + 1))
    square, total = share * share, np.zeros(values.shape)
    for odd in range(37, 0, -2):
        total = total * square + 1 / odd
    return 2 * share * total + np.where(small, 0, power) * _LOG_2


@dataclass(frozen=True, eq=False)
class RectifiedPair(Record):
    """A pair whose matches lie on common rows, with the homographies from the original, undistorted pictures to it."""

    views: Views
    left_homography: Float64[np.ndarray, "3 3"]
    right_homography: Float64[np.ndarray, "3 3"]
    original_shape: tuple[int, int]
    offset_px: float
    """Added to a disparity of `views`; `rectify` moves the right view so that none is negative."""
    skipped: bool
    why: str
    left_radial: float = 0.0
    right_radial: float = 0.0
    verified_px: tuple[int, int] | None = None
    """Lowest and highest disparity, in `views`, of the matches used; None if skipped."""

    def warp(self, views: Views) -> "RectifiedPair":
        """Warp other pictures of the same cameras by the same homographies."""
        if self.skipped or views.right is None:
            return replace(self, views=views)
        height, width = self.views.shape
        left = _warp(views.left, self.left_homography, self.left_radial, width, height)
        right = _warp(views.right, self.right_homography, self.right_radial, width, height)
        return replace(self, views=Views(left, right))

    def to_original(self, disparity: DisparityMap) -> DisparityMap:
        """Map a disparity map of `views` to the original left picture, plus offset_px; unknown outside of the view."""
        if self.skipped:
            return disparity
        return DisparityMap(
            self._sample(disparity.disparity_px, np.nan) + np.float32(self.offset_px),
            self._sample(disparity.confidence, 0),
            disparity.unit,
        )

    def right_px(self, disparity_px: Float32[np.ndarray, "h w"]) -> Float64[np.ndarray, "h w 2"]:
        """Return each original left pixel's place in the original right picture, by a map from `to_original`."""
        left = self.left_place_px(_pixels(self.original_shape))
        left[:, 0] -= disparity_px.ravel().astype(np.float64) - self.offset_px
        straight = transform(inverse(self.right_homography), left)
        return distort(straight, self.right_radial, self.original_shape).reshape(*self.original_shape, 2)

    def left_place_px(self, points_px: np.ndarray) -> Float64[np.ndarray, "n 2"]:
        """Map points (n, 2) of the original left picture to `views`."""
        return transform(self.left_homography, undistort(points_px, self.left_radial, self.original_shape))

    def right_place_px(self, points_px: np.ndarray) -> Float64[np.ndarray, "n 2"]:
        """Map points (n, 2) of the original right picture to `views`."""
        return transform(self.right_homography, undistort(points_px, self.right_radial, self.original_shape))

    def _sample(self, values: Float32[np.ndarray, "h w"], outside: float) -> Float32[np.ndarray, "rows columns"]:
        """Sample the nearest value: an average across a depth edge would belong to neither surface."""
        rows, columns = self.original_shape
        if self.left_radial:
            return _sample_nearest(values, self.left_place_px(_pixels(self.original_shape)), outside).reshape(
                rows, columns
            )
        with plain_opencv():
            return cv2.warpPerspective(
                values,
                self.left_homography,
                (columns, rows),
                flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP,
                borderMode=cv2.BORDER_CONSTANT,
                borderValue=outside,
            )


def unchanged_pair(views: Views, why: str) -> RectifiedPair:
    """Return a pair unchanged; `why` gives the reason."""
    return RectifiedPair(views, np.eye(3), np.eye(3), views.shape, 0.0, True, why)


def warp_pair(
    views: Views,
    pair: tuple[np.ndarray, np.ndarray],
    why: str,
    start_px: int = 0,
    radials: tuple[float, float] = (0.0, 0.0),
    verified_px: tuple[int, int] | None = None,
) -> RectifiedPair:
    """Warp both pictures onto a canvas of the whole left one, the right one moved so that start_px becomes zero."""
    if views.right is None:
        raise PictureError("rectification needs two views; give a right one")
    border = _border(views.shape, radials[0] != 0)
    quad = transform(pair[0], undistort(border, radials[0], views.shape))
    origin, end = np.floor(quad.min(axis=0)), np.ceil(quad.max(axis=0))
    width, height = (int(size) + 1 for size in end - origin)
    left, right = _translate(pair[0], origin), _translate(pair[1], origin - [start_px, 0])
    warped_views = Views(
        _warp(views.left, left, radials[0], width, height), _warp(views.right, right, radials[1], width, height)
    )
    verified_range_px = None if verified_px is None else (verified_px[0] - start_px, verified_px[1] - start_px)
    return RectifiedPair(
        warped_views, left, right, views.shape, float(start_px), False, why, *radials, verified_range_px
    )


def _border(shape: tuple[int, int], is_curved: bool) -> Float64[np.ndarray, "n 2"]:
    """Return the corners of a picture and, if its sides become curves, points along them."""
    rows, columns = shape
    steps = np.linspace(0, 1, 33 if is_curved else 2)
    sides = [np.column_stack([steps, np.full(len(steps), end)]) for end in (0, 1)]
    return np.vstack([*sides, *(side[:, ::-1] for side in sides)]) * [columns - 1, rows - 1]


def _translate(homography: np.ndarray, origin: np.ndarray) -> Float64[np.ndarray, "3 3"]:
    return product(np.array([[1, 0, -origin[0]], [0, 1, -origin[1]], [0, 0, 1.0]]), homography)


def _warp(picture: np.ndarray, homography: np.ndarray, radial: float, width: int, height: int) -> np.ndarray:
    if picture.dtype not in (np.uint8, np.uint16, np.float32, np.float64):
        picture = picture.astype(np.float32)
    raw = np.ascontiguousarray(picture)
    cubic, edge = cv2.INTER_CUBIC, cv2.BORDER_REPLICATE
    with plain_opencv():
        if radial:
            straight = transform(inverse(homography), _pixels((height, width)))
            columns, rows = distort(straight, radial, picture.shape[:2]).astype(np.float32).T.reshape(2, height, -1)
            result = cv2.remap(raw, columns, rows, cubic, borderMode=edge)
        else:
            result = cv2.warpPerspective(raw, homography, (width, height), flags=cubic, borderMode=edge)
    return np.clip(result, picture.min(), picture.max(), out=result)


def _sample_nearest(
    values: Float32[np.ndarray, "h w"], places_px: np.ndarray, outside: float
) -> Float32[np.ndarray, "n"]:
    columns, rows = np.rint(places_px).astype(np.int64).T
    inside = (columns >= 0) & (columns < values.shape[1]) & (rows >= 0) & (rows < values.shape[0])
    samples = np.full(len(places_px), outside, np.float32)
    samples[inside] = values[rows[inside], columns[inside]]
    return samples


def _pixels(shape: tuple[int, int]) -> Float64[np.ndarray, "n 2"]:
    rows, columns = np.indices(shape, np.float64)
    return np.column_stack([columns.ravel(), rows.ravel()])
