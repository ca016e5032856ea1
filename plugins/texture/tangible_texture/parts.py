"""Connected parts of classes."""

import numpy as np
from jaxtyping import Int32

from .watershed import UNSEEN, watershed


def without_small_parts(classes: Int32[np.ndarray, "h w"], smallest_px: int) -> Int32[np.ndarray, "h w"]:
    """Parts (4 neighbours) of fewer pixels go to the classes beside them; where all are small, all are 0."""
    if smallest_px <= 1:
        return classes
    found = np.full(classes.shape, UNSEEN, np.int32)
    for each in range(int(classes.max()) + 1):
        _add_large_parts(found, classes == each, each, smallest_px)
    if found.max() == UNSEEN:
        return np.zeros_like(classes)
    return watershed(np.zeros(classes.shape, np.float32), found)


def _add_large_parts(found: Int32[np.ndarray, "h w"], mask: np.ndarray, label: int, smallest_px: int) -> None:
    import cv2

    count, parts = cv2.connectedComponents(mask.view(np.uint8), connectivity=4)
    numbers = np.asarray(parts, np.int32)
    large = np.bincount(numbers.ravel(), minlength=count) >= smallest_px
    large[0] = False
    found[large[numbers]] = label
