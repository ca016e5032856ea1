"""Flat basins of a landscape: where segments begin. Compiled by numba where every pixel is visited."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float32, Int32
from numba import njit

from .watershed import UNSEEN


def basins(
    height: Float32[np.ndarray, "h w"], levels: Iterable[float], smallest_px: int
) -> tuple[Int32[np.ndarray, "h w"], int]:
    """Connected parts (4 neighbours) that lie at or under a level and hold smallest_px pixels or more.

    The levels rise. At a higher one, only parts in which no basin lies yet are new: so a rough thing between smooth
    ones has a basin of its own, although it is nowhere as flat as they are.
    Returns: labels, -1 outside of the basins, and their number.
    """
    import cv2

    found = np.full(height.shape, UNSEEN, np.int32)
    count = 0
    for level in levels:
        size, parts = cv2.connectedComponents((height <= level).view(np.uint8), connectivity=4)
        count = _add(found, parts, size, smallest_px, count)
    return found, count


@njit(cache=True, nogil=True)
def _add(found, parts, size, smallest_px, count):
    """Write the large parts without a basin into `found`, under names from `count` on; part 0 is what is too high."""
    areas = np.zeros(size, np.int64)
    taken = np.zeros(size, np.bool_)
    for row in range(found.shape[0]):
        for column in range(found.shape[1]):
            areas[parts[row, column]] += 1
            taken[parts[row, column]] |= found[row, column] >= 0
    names = np.full(size, UNSEEN, np.int32)
    for part in range(1, size):
        if areas[part] >= smallest_px and not taken[part]:
            names[part] = count
            count += 1
    if names.max() == UNSEEN:
        return count
    for row in range(found.shape[0]):
        for column in range(found.shape[1]):
            found[row, column] = max(found[row, column], names[parts[row, column]])
    return count
