"""A pair of pictures turned so that rows correspond, and the way back."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float32, Float64

from tangible_core.data import DisparityMap, Record, Views
from tangible_core.errors import PictureError
from tangible_core.runtime.opencv import plain_opencv

from .epipolar import product
from .homographies import inverse, transform
from .lenses import distorted, undistorted


@dataclass(frozen=True, eq=False)
class RectifiedPair(Record):
    """A pair whose matches lie on one row, how it came about, and the way back to the pictures as they were.

    left_homography, right_homography: (3, 3), from a point of the original picture, free of its lens's distortion, to
    its place in `views`; left_radial, right_radial: that distortion (see `lenses`), 0 for none.
    offset_px: what to add to a disparity found in `views`; `rectify` moves the right view so that none is negative.
    why: what was done or why nothing was, in words; `skipped` tells which.
    seen_px: lowest and highest disparity, in `views`, of the matches that it was made from; None if it was skipped.
    """

    views: Views
    left_homography: Float64[np.ndarray, "3 3"]
    right_homography: Float64[np.ndarray, "3 3"]
    original_shape: tuple[int, int]
    offset_px: float
    skipped: bool
    why: str
    left_radial: float = 0.0
    right_radial: float = 0.0
    seen_px: tuple[int, int] | None = None

    def again(self, views: Views) -> "RectifiedPair":
        """Other pictures of the same cameras, turned alike."""
        if self.skipped or views.right is None:
            return replace(self, views=views)
        height, width = self.views.shape
        left = _warp(views.left, self.left_homography, self.left_radial, width, height)
        right = _warp(views.right, self.right_homography, self.right_radial, width, height)
        return replace(self, views=Views(left, right))

    def to_original(self, found: DisparityMap) -> DisparityMap:
        """A disparity map of `views` as one of the original left picture: same values plus offset_px, at their pixels.

        Pixels of the original that the rectified view does not show are unknown.
        """
        if self.skipped:
            return found
        return DisparityMap(
            self._sample(found.disparity_px, np.nan) + np.float32(self.offset_px),
            self._sample(found.confidence, 0),
            found.unit,
        )

    def right_px(self, disparity_px: Float32[np.ndarray, "h w"]) -> Float64[np.ndarray, "h w 2"]:
        """Where each original left pixel is seen in the original right picture, by a map from `to_original`."""
        left = self.left_place_px(_pixels(self.original_shape))
        left[:, 0] -= disparity_px.ravel().astype(np.float64) - self.offset_px
        straight = transform(inverse(self.right_homography), left)
        return distorted(straight, self.right_radial, self.original_shape).reshape(*self.original_shape, 2)

    def left_place_px(self, points_px: np.ndarray) -> Float64[np.ndarray, "n 2"]:
        """Where `views` shows points (n, 2) of the original left picture."""
        return transform(self.left_homography, undistorted(points_px, self.left_radial, self.original_shape))

    def right_place_px(self, points_px: np.ndarray) -> Float64[np.ndarray, "n 2"]:
        """Where `views` shows points (n, 2) of the original right picture."""
        return transform(self.right_homography, undistorted(points_px, self.right_radial, self.original_shape))

    def _sample(self, values: Float32[np.ndarray, "h w"], outside: float) -> Float32[np.ndarray, "rows columns"]:
        """The nearest value: an average across an edge of depth would be neither side's."""
        import cv2

        rows, columns = self.original_shape
        if self.left_radial:
            return _nearest(values, self.left_place_px(_pixels(self.original_shape)), outside).reshape(rows, columns)
        with plain_opencv():
            return cv2.warpPerspective(
                values,
                self.left_homography,
                (columns, rows),
                flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP,
                borderMode=cv2.BORDER_CONSTANT,
                borderValue=outside,
            )


def as_it_is(views: Views, why: str) -> RectifiedPair:
    """A pair whose rows correspond already, or of which nobody can tell."""
    return RectifiedPair(views, np.eye(3), np.eye(3), views.shape, 0.0, True, why)


def warped(
    views: Views,
    pair: tuple[np.ndarray, np.ndarray],
    why: str,
    start_px: int = 0,
    radials: tuple[float, float] = (0.0, 0.0),
    seen_px: tuple[int, int] | None = None,
) -> RectifiedPair:
    """Both pictures on a canvas that holds the whole left one, the right one moved so that start_px becomes zero.

    pair: homographies (left, right), each (3, 3), that bring matches onto common rows once the distortion `radials`
    of their lenses is taken out. seen_px: disparities of these matches, before start_px becomes zero.
    """
    if views.right is None:
        raise PictureError("rectification needs two views; give a right one")
    quad = transform(pair[0], undistorted(_border(views.shape, radials[0] != 0), radials[0], views.shape))
    origin, end = np.floor(quad.min(axis=0)), np.ceil(quad.max(axis=0))
    width, height = (int(size) + 1 for size in end - origin)
    left, right = _moved(pair[0], origin), _moved(pair[1], origin - [start_px, 0])
    turned = Views(
        _warp(views.left, left, radials[0], width, height), _warp(views.right, right, radials[1], width, height)
    )
    seen = None if seen_px is None else (seen_px[0] - start_px, seen_px[1] - start_px)
    return RectifiedPair(turned, left, right, views.shape, float(start_px), False, why, *radials, seen)


def _border(shape: tuple[int, int], curved: bool) -> Float64[np.ndarray, "n 2"]:
    """Corners of a picture and, where its sides become curves, points along them."""
    rows, columns = shape
    steps = np.linspace(0, 1, 33 if curved else 2)
    sides = [np.column_stack([steps, np.full(len(steps), end)]) for end in (0, 1)]
    return np.vstack([*sides, *(each[:, ::-1] for each in sides)]) * [columns - 1, rows - 1]


def _moved(homography: np.ndarray, origin: np.ndarray) -> Float64[np.ndarray, "3 3"]:
    return product(np.array([[1, 0, -origin[0]], [0, 1, -origin[1]], [0, 0, 1.0]]), homography)


def _warp(picture: np.ndarray, homography: np.ndarray, radial: float, width: int, height: int) -> np.ndarray:
    import cv2

    if picture.dtype not in (np.uint8, np.uint16, np.float32, np.float64):
        picture = picture.astype(np.float32)
    raw = np.ascontiguousarray(picture)
    cubic, edge = cv2.INTER_CUBIC, cv2.BORDER_REPLICATE
    with plain_opencv():
        if radial:
            straight = transform(inverse(homography), _pixels((height, width)))
            columns, rows = distorted(straight, radial, picture.shape[:2]).astype(np.float32).T.reshape(2, height, -1)
            warped = cv2.remap(raw, columns, rows, cubic, borderMode=edge)
        else:
            warped = cv2.warpPerspective(raw, homography, (width, height), flags=cubic, borderMode=edge)
    return np.clip(warped, picture.min(), picture.max(), out=warped)


def _nearest(values: Float32[np.ndarray, "h w"], places_px: np.ndarray, outside: float) -> Float32[np.ndarray, "n"]:
    columns, rows = np.rint(places_px).astype(np.int64).T
    inside = (columns >= 0) & (columns < values.shape[1]) & (rows >= 0) & (rows < values.shape[0])
    found = np.full(len(places_px), outside, np.float32)
    found[inside] = values[rows[inside], columns[inside]]
    return found


def _pixels(shape: tuple[int, int]) -> Float64[np.ndarray, "n 2"]:
    rows, columns = np.indices(shape, np.float64)
    return np.column_stack([columns.ravel(), rows.ravel()])
