"""Flat basins of a landscape, the seeds of segments. Compiled by numba where every pixel is visited."""

from collections.abc import Iterable

import cv2
import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.compiled import KERNEL, inner, njit

from .watershed import UNSEEN

MAX_SEGMENTS = 64
"""The largest number of segments under `auto`, far more than touch can distinguish."""
STEEPER = (1, 4, 16)
"""The multiples of the flat threshold, tried in turn where nothing is flat enough."""
_SEVERAL = -2


def basins(
    height: Float32[np.ndarray, "h w"], levels: Iterable[float], smallest_px: int
) -> tuple[Int32[np.ndarray, "h w"], int]:
    """Label connected parts (4 neighbours) of smallest_px or more at or under rising levels, -1 elsewhere."""
    labels = np.full(height.shape, UNSEEN, np.int32)
    count = 0
    # At a higher level, a part without a basin becomes a new one: a rough object between smooth ones has its own,
    # although it is nowhere as flat. A part with one basin is all of that basin: water fills it before it flows over.
    for level in levels:
        size, parts = cv2.connectedComponents((height <= level).view(np.uint8), connectivity=4)
        owners, areas = np.full(size, UNSEEN, np.int32), np.zeros(size, np.int32)
        count = _label_parts(labels, parts, owners, areas, smallest_px, count)
    return labels, count


@njit(**KERNEL)
def _label_parts(labels, parts, names, areas, smallest_px, count):
    """Give every part with one basin to that basin, every large part without one to a new basin, from `count` on."""
    _find_owners(labels, parts, names, areas)
    names[0] = _SEVERAL  # part 0 is above the level
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
    """Write the basin in each part, -1 if there is none, -2 if there are several; and the areas of the parts."""
    for row in range(labels.shape[0]):
        for column in range(labels.shape[1]):
            part, basin = parts[row, column], labels[row, column]
            areas[part] += 1
            if basin >= 0 and owners[part] != basin:
                owners[part] = basin if owners[part] == UNSEEN else _SEVERAL
