"""Connected parts of classes."""

import numpy as np
from jaxtyping import Float32, Int32

from .watershed import UNSEEN, watershed


def remove_small_parts(
    classes: Int32[np.ndarray, "h w"], steep: Float32[np.ndarray, "h w"], flat: float, smallest_px: int
) -> Int32[np.ndarray, "h w"]:
    """Parts (4 neighbours) of fewer flat pixels go to the classes beside them, up to the steepest pixels in between.

    What is steeper than `flat` is in no part: on an edge from dark to bright lies no segment of grey.
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
