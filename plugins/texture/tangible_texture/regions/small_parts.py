"""Removal of small connected parts of classes."""

import numpy as np
from jaxtyping import Float32, Int32

from .watershed import UNSEEN, watershed


def remove_small_parts(
    classes: Int32[np.ndarray, "h w"], steep: Float32[np.ndarray, "h w"], flat: float, smallest_px: int
) -> Int32[np.ndarray, "h w"]:
    """Give parts (4 neighbours) of fewer flat pixels to the adjacent classes, up to the steepest pixels in between.

    Pixels steeper than `flat` are in no part: an edge from dark to bright is not a segment of grey.
    Returns: classes; all are 0 where all parts are small.
    """
    markers = np.full(classes.shape, UNSEEN, np.int32)
    for each in range(int(classes.max()) + 1):
        _add_large_parts(markers, (classes == each) & (steep <= flat), each, smallest_px)
    if markers.max() == UNSEEN:
        return np.zeros_like(classes)
    return watershed(steep, markers)


def _add_large_parts(markers: Int32[np.ndarray, "h w"], mask: np.ndarray, label: int, smallest_px: int) -> None:
    import cv2

    count, parts = cv2.connectedComponents(mask.view(np.uint8), connectivity=4)
    numbers = np.asarray(parts, np.int32)
    large = np.bincount(numbers.ravel(), minlength=count) >= smallest_px
    large[0] = False
    markers[large[numbers]] = label
