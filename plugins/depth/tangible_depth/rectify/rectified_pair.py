"""A rectified pair of pictures, and the map back to the originals."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from jaxtyping import Float32, Float64

from tangible_core.data import DisparityMap, Record, Views
from tangible_core.errors import PictureError
from tangible_core.runtime import plain_opencv

from .projective import distort, inverse, product, transform, undistort


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
