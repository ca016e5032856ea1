"""Flat basins of a landscape: where segments begin. Compiled by numba where every pixel is visited."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float32, Int32
from numba import njit

from tangible_core.compiled.compiling import KERNEL, inner

from .watershed import UNSEEN

MOST_SEGMENTS = 64
"""What `segments: auto` stops at, far beyond what touch tells apart."""
STEEPER = (1, 4, 16)
"""Where nothing is flat, a part this many times as steep counts as flat."""
_SEVERAL = -2


def basins(
    height: Float32[np.ndarray, "h w"], levels: Iterable[float], smallest_px: int
) -> tuple[Int32[np.ndarray, "h w"], int]:
    """Connected parts (4 neighbours) that lie at or under a level and hold smallest_px pixels or more.

    The levels rise. At a higher one, a part with no basin in it yet is a new one: so a rough thing between smooth ones
    has a basin of its own, although it is nowhere as flat as they are. A part with one basin in it is all that basin's,
    as a watershed would find too: water fills it before it flows over.
    Returns: labels, -1 outside of the basins, and their number.
    """
    import cv2

    labels = np.full(height.shape, UNSEEN, np.int32)
    count = 0
    for level in levels:
        size, parts = cv2.connectedComponents((height <= level).view(np.uint8), connectivity=4)
        owners, areas = np.full(size, UNSEEN, np.int32), np.zeros(size, np.int32)
        count = _label_parts(labels, parts, owners, areas, smallest_px, count)
    return labels, count


@njit(**KERNEL)
def _label_parts(labels, parts, names, areas, smallest_px, count):
    """Give every part with one basin in it to that basin, every large one without to a new one, from `count` on.

    names, areas: scratch, -1 and 0 for each part.
    """
    _find_owners(labels, parts, names, areas)
    names[0] = _SEVERAL  # what is too high
    for part in range(1, names.size):
        if names[part] == UNSEEN and areas[part] >= smallest_px:
            names[part] = count
            count += 1
    for row in range(labels.shape[0]):
        for column in range(labels.shape[1]):
            labels[row, column] = max(labels[row, column], names[parts[row, column]], UNSEEN)
    return count


@inner()
def _find_owners(labels, parts, owners, areas):
    """The basin in each part, -1 if there is none, -2 if there are several; and the areas of the parts."""
    for row in range(labels.shape[0]):
        for column in range(labels.shape[1]):
            part, basin = parts[row, column], labels[row, column]
            areas[part] += 1
            if basin >= 0 and owners[part] != basin:
                owners[part] = basin if owners[part] == UNSEEN else _SEVERAL
