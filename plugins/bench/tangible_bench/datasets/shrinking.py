"""Shrinking of pairs to a half, a third or a quarter of their size."""

import numpy as np
from jaxtyping import Bool, Float32

from tangible_core.data import Calibration, Views
from tangible_core.runtime import plain_opencv


def shrink_views(views: Views, by: int) -> Views:
    """Replace blocks of `by` x `by` pixels by their mean; rows and columns that are left over at the end are cut."""
    if by == 1:
        return views
    old = views.calibration
    cameras = old and Calibration(old.focal_px / by, old.baseline_m, old.offset_px / by)
    return Views(_mean(views.left, by), None if views.right is None else _mean(views.right, by), cameras)


def shrink_truth(truth_px: Float32[np.ndarray, "h w"], by: int) -> Float32[np.ndarray, "r c"]:
    """Return the upper median of the known values of blocks, in pixels of the smaller size; NaN if most are unknown.

    A mean would lie between the two surfaces at an edge, where there is nothing.
    """
    if by == 1:
        return truth_px
    blocks = np.sort(_blocks(truth_px, by), axis=-1)  # NaN last
    known = np.isfinite(blocks).sum(axis=-1)
    middle = np.take_along_axis(blocks, np.minimum(known // 2, by * by - 1)[..., None], axis=-1)[..., 0]
    return np.where(2 * known >= by * by, middle / np.float32(by), np.float32(np.nan))


def shrink_mask(mask: Bool[np.ndarray, "h w"], by: int) -> Bool[np.ndarray, "r c"]:
    """Return a mask of the blocks of which most pixels are marked."""
    return mask if by == 1 else 2 * _blocks(mask, by).sum(axis=-1) > by * by


def _mean(picture: np.ndarray, by: int) -> np.ndarray:
    import cv2

    rows, columns = (max(1, side // by) for side in picture.shape[:2])
    whole = np.ascontiguousarray(picture[: rows * by, : columns * by])
    with plain_opencv():
        return cv2.resize(whole, (columns, rows), interpolation=cv2.INTER_AREA)


def _blocks(values: np.ndarray, by: int) -> np.ndarray:
    """Return the blocks, (rows, columns, by * by). A side shorter than `by` is repeated at its end."""
    rows, columns = (max(1, side // by) for side in values.shape)
    short = [(0, max(0, by - side)) for side in values.shape]
    whole = np.pad(values, short, mode="edge")[: rows * by, : columns * by]
    return whole.reshape(rows, by, columns, by).swapaxes(1, 2).reshape(rows, columns, by * by)
