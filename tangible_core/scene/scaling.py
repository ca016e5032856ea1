"""Views at a size that can be felt, and what is found in them at the size of the pictures again."""

import numpy as np

from ..data import DisparityMap, SegmentMap, Views
from ..runtime.opencv import plain_opencv


def felt_factor(columns: int, width_m: float, finest_m: float) -> int:
    """By how much a picture of so many columns can be reduced before a pixel is wider than finest_m; at least 1.

    >>> felt_factor(6000, 0.08, 3e-5), felt_factor(741, 0.08, 3e-5)
    (2, 1)
    """
    return max(1, int(finest_m * columns / width_m))


def reduced(views: Views, factor: int) -> Views:
    """Views of 1/factor of the size, each pixel a mean over its area; without calibration, whose pixels are others."""
    if factor == 1:
        return views
    rows, columns = (max(1, round(side / factor)) for side in views.shape)
    right = None if views.right is None else _mean(views.right, rows, columns)
    return Views(_mean(views.left, rows, columns), right)


def enlarged(disparity: DisparityMap, shape: tuple[int, int]) -> DisparityMap:
    """The disparity of reduced views for views of (h, w), in their pixels; between pixels it is linear."""
    if disparity.disparity_px.shape == shape:
        return disparity
    scale = shape[1] / disparity.disparity_px.shape[1] if disparity.unit == "px" else 1.0
    values = _resized(disparity.disparity_px, shape) * np.float32(scale)
    return DisparityMap(values, _resized(disparity.confidence, shape), disparity.unit)


def enlarged_segments(segments: SegmentMap, shape: tuple[int, int]) -> SegmentMap:
    """The segments of a reduced picture for one of (h, w): of the nearest pixel, in the same order of labels."""
    import cv2

    if segments.labels.shape == shape:
        return segments
    nearest = np.asarray(cv2.resize(segments.labels, shape[::-1], interpolation=cv2.INTER_NEAREST_EXACT), np.int32)
    with plain_opencv():
        confidence = np.asarray(cv2.resize(segments.confidence, shape[::-1], interpolation=cv2.INTER_LINEAR))
    return SegmentMap(nearest, confidence)


def _mean(picture: np.ndarray, rows: int, columns: int) -> np.ndarray:
    import cv2

    if picture.dtype == np.bool_:
        picture = picture.astype(np.uint8) * np.uint8(255)
    elif picture.dtype.itemsize not in (1, 2, 4) or picture.dtype == np.float16:
        picture = picture.astype(np.float32)
    with plain_opencv():
        return np.asarray(cv2.resize(picture, (columns, rows), interpolation=cv2.INTER_AREA))


def _resized(values: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Linear between known values; beside a hole, the nearest one."""
    import cv2

    size = shape[1], shape[0]
    with plain_opencv():
        linear = np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_LINEAR))
    return np.where(np.isnan(linear), np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_NEAREST)), linear)
