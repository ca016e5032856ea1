"""Candidates at the left border by geodesic distance: the path of least grey change to a known pixel.

The right view does not show the left border, so a wide strip there has no matches, and no known pixel of its surface
may lie straight ahead. The geodesic path may turn; two sweeps, forth and back as in a chamfer transform, find it.
Source of the sweeps: Toivanen, New geodesic distance transforms for gray-scale images, Pattern Recognition Letters 17,
1996.
"""

# ruff: noqa: ANN001, ANN202 -- numba infers the types of kernels; their docstrings give them

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, Int32, Int64, UInt8
from numba import int32

from tangible_core.compiled.compiling import KERNEL, njit

from ..span import UNKNOWN

PER_PIXEL = 1
"""Length of a step to a neighbour of equal grey, in grey levels."""
SWEEPS = (-1, 1)
"""Directions of the sweeps: from the last pixel to the first, as known pixels lie to the right, and back."""
NO_WAY = np.int32(1 << 28)
"""Length where no path leads to a known pixel, in grey levels: longer than any path."""


class GeodesicCandidates(NamedTuple):
    """Disparity at the end of the shortest path of each pixel before the first known one of its row."""

    first: Int64[np.ndarray, " h"]
    """The first known column of each row; 0 without one, as the width of the border is unknown there."""
    values: Int16[np.ndarray, "h columns"]
    """The disparities, in sixteenths of a pixel, UNKNOWN without a path."""
    lengths: Int32[np.ndarray, "h columns"]
    """The lengths of the paths, in grey levels."""


def geodesic_candidates(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> GeodesicCandidates:
    """Find the candidates of a map in sixteenths of a pixel; UNKNOWN where no path leads to a known pixel."""
    known = disparity != UNKNOWN
    first = known.argmax(axis=1)
    part = slice(None), slice(int(first.max()) + 1)
    values = np.pad(disparity[part], 1, constant_values=UNKNOWN)
    lengths = np.pad(np.where(known[part], np.int32(0), NO_WAY), 1, constant_values=NO_WAY)
    greys = np.pad(grey[part].astype(np.int32), 1)
    for step in SWEEPS:
        _sweep(greys, first, step, values, lengths)
    return GeodesicCandidates(first, values[1:-1, 1:-1], lengths[1:-1, 1:-1])


@njit(**KERNEL)
def _sweep(grey, first, step, values, lengths):
    """Shorten the paths in one sweep; arrays have a margin of one pixel. No path crosses the margin or a later gap."""
    h = first.size
    for i in range(h):
        y = i + 1 if step > 0 else h - i
        v = y - step
        for j in range(first[y - 1]):
            x = j + 1 if step > 0 else first[y - 1] - j
            here = grey[y, x]
            length, value = lengths[y, x], values[y, x]
            ahead = lengths[y, x - step] + abs(grey[y, x - step] - here) + int32(PER_PIXEL)
            value = values[y, x - step] if ahead < length else value
            length = min(length, ahead)
            for u in range(x - 1, x + 2):
                ahead = lengths[v, u] + abs(grey[v, u] - here) + int32(PER_PIXEL)
                value = values[v, u] if ahead < length else value
                length = min(length, ahead)
            lengths[y, x], values[y, x] = length, value
