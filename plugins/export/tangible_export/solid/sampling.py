"""The nodes of a surface: no more of them than fit in memory."""

import logging
from math import sqrt

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.data import Relief
from tangible_core.plugins.notes import note
from tangible_core.runtime.opencv import plain_opencv

log = logging.getLogger(__name__)

LEAST = 2
"""Nodes along a side: one pixel is a surface too."""


def sampled(relief: Relief, most_nodes: int, cure: str) -> Relief:
    """The same surface with at least two nodes a side, and at most `most_nodes` in all.

    Where there are more, heights are averaged, and a note says so with the cure.
    """
    rows, columns = (side if side >= LEAST else 3 for side in relief.height_m.shape)
    if (nodes := rows * columns) > most_nodes:
        scale = sqrt(most_nodes / nodes)
        rows, columns = (max(LEAST, int(scale * side)) for side in (rows, columns))
        side_mm = 1000 * max(relief.extent_m[0] / columns, relief.extent_m[1] / rows)
        told = f"heights are averaged over squares of {side_mm:.2g} mm, as {nodes / 1e6:.3g} million nodes"
        note(log, f"{told} would take too much memory and too large a file; {cure}", logging.WARNING)
    return Relief(_resized(relief.height_m, (rows, columns)), relief.extent_m)


def _resized(heights: Float32[np.ndarray, "h w"], shape: tuple[int, int]) -> Float32[np.ndarray, "h2 w2"]:
    if shape == heights.shape:
        return heights
    smaller = shape[0] < heights.shape[0] and shape[1] < heights.shape[1]
    with plain_opencv():
        sized = cv2.resize(heights, shape[::-1], interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)
    return np.maximum(sized, 0).astype(np.float32)
