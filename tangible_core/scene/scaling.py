"""Reduction of pictures and maps to a size that can be felt, and enlargement of results to the pictures' size."""

import numpy as np
from jaxtyping import Bool, Float32, Int32

from ..data import DisparityMap, PartMap, SegmentMap, Views
from ..runtime.opencv import cv2, plain_opencv


def felt_factor(columns: int, width_m: float, finest_m: float) -> float:
    """Return the factor by which a picture can be reduced before a pixel is wider than finest_m; in halves, from 1."""
    return max(1, int(2 * finest_m * columns / width_m) / 2)


def reduced_shape(shape: tuple[int, int], factor: float) -> tuple[int, int]:
    """Return the rows and columns of a picture reduced to 1/factor; at least one of each."""
    rows, columns = (max(1, round(side / factor)) for side in shape)
    return rows, columns


def reduce_views(views: Views, factor: float) -> Views:
    """Reduce views to 1/factor, each pixel a mean over its area; the calibration, in other pixels, is dropped."""
    if factor == 1:
        return views
    rows, columns = reduced_shape(views.shape, factor)
    right = None if views.right is None else _mean(views.right, rows, columns)
    return Views(_mean(views.left, rows, columns), right)


def reduced_map(values: Float32[np.ndarray, "h w"], shape: tuple[int, int]) -> Float32[np.ndarray, "r c"]:
    """Reduce a map to (r, c), each value the mean of the known values in its area; NaN if less than half is known."""
    if values.shape == shape:
        return values
    valid_mask = np.isfinite(values)
    if valid_mask.all():
        return _mean(values, *shape)
    size = np.float32(np.abs(values[valid_mask]).max(initial=0)) or np.float32(1)  # divided out: sums stay finite
    share = _mean(valid_mask.astype(np.float32), *shape)
    sums = _mean(np.where(valid_mask, values / size, np.float32(0)), *shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(share >= 0.5, sums / share * size, np.float32(np.nan))


def reduced_mask(mask: Bool[np.ndarray, "h w"], shape: tuple[int, int]) -> Bool[np.ndarray, "r c"]:
    """Reduce a mask to (r, c), True where at least half of an area is True."""
    return mask if mask.shape == shape else _mean(mask.astype(np.float32), *shape) >= 0.5


def reduced_disparity(disparity: DisparityMap, shape: tuple[int, int]) -> DisparityMap:
    """Reduce disparity to a coarser grid of (r, c); its unit stays pixels of the pictures."""
    if disparity.disparity_px.shape == shape:
        return disparity
    values = reduced_map(disparity.disparity_px, shape)
    return DisparityMap(values, _mean(disparity.confidence, *shape), disparity.unit)


def reduced_segments(segments: SegmentMap, shape: tuple[int, int]) -> SegmentMap:
    """Reduce segments to a coarser grid of (r, c), by the middle pixel of each cell; no segment is lost."""
    whole = segments.labels
    if whole.shape == shape:
        return segments
    labels = middle_pixels(whole, shape)
    for lost in np.setdiff1d(np.arange(segments.count), labels):
        row, column = np.argwhere(whole == lost)[0]
        labels[row * shape[0] // whole.shape[0], column * shape[1] // whole.shape[1]] = lost
    return SegmentMap(labels, _mean(segments.confidence, *shape))


def middle_pixels(labels: Int32[np.ndarray, "h w"], shape: tuple[int, int]) -> Int32[np.ndarray, "r c"]:
    """Reduce labels to a coarser grid of (r, c), by the middle pixel of each cell."""
    steps = zip(shape, labels.shape, strict=True)
    return labels[np.ix_(*(np.arange(new) * old // new + old // new // 2 for new, old in steps))]


def to_picture_pixels(disparity: DisparityMap, columns: int) -> DisparityMap:
    """Convert disparity of reduced views, on their grid, to pixels of the pictures, which have this many columns."""
    if disparity.unit != "px" or disparity.disparity_px.shape[1] == columns:
        return disparity
    scale = np.float32(columns / disparity.disparity_px.shape[1])
    return DisparityMap(disparity.disparity_px * scale, disparity.confidence, disparity.unit)


def on_grid(disparity: DisparityMap, shape: tuple[int, int]) -> DisparityMap:
    """Interpolate disparity on a finer grid of (h, w), linearly; its values stay."""
    if disparity.disparity_px.shape == shape:
        return disparity
    return DisparityMap(_resize(disparity.disparity_px, shape), _resize(disparity.confidence, shape), disparity.unit)


def enlarged_segments(segments: SegmentMap, shape: tuple[int, int]) -> SegmentMap:
    """Enlarge the segments of a reduced picture to (h, w), by the nearest pixel, in the same order of labels."""
    if segments.labels.shape == shape:
        return segments
    with plain_opencv():
        confidence = np.asarray(cv2.resize(segments.confidence, shape[::-1], interpolation=cv2.INTER_LINEAR))
    return SegmentMap(_nearest(segments.labels, shape), confidence)


def enlarged_parts(parts: PartMap, shape: tuple[int, int]) -> PartMap:
    """Enlarge the parts of a reduced picture to (h, w), by the nearest pixel, with the same numbers."""
    return parts if parts.labels.shape == shape else PartMap(_nearest(parts.labels, shape), parts.segments)


def _nearest(labels: Int32[np.ndarray, "h w"], shape: tuple[int, int]) -> Int32[np.ndarray, "r c"]:
    return np.asarray(cv2.resize(labels, shape[::-1], interpolation=cv2.INTER_NEAREST_EXACT), np.int32)


def _mean(picture: np.ndarray, rows: int, columns: int) -> np.ndarray:
    if picture.dtype == np.bool_:
        picture = picture.astype(np.uint8) * np.uint8(255)
    elif picture.dtype.itemsize not in (1, 2, 4) or picture.dtype == np.float16:
        picture = picture.astype(np.float32)
    with plain_opencv():
        return np.asarray(cv2.resize(picture, (columns, rows), interpolation=cv2.INTER_AREA))


def _resize(values: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    size = shape[1], shape[0]
    with plain_opencv():
        linear = np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_LINEAR))
    return np.where(np.isnan(linear), np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_NEAREST)), linear)
