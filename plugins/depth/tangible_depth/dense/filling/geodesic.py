"""What a pixel at the left border, where the right view ends, has in common with known ones round a corner.

Nothing that the right view does not show is known there, and a wide strip may have no known pixel straight on that
is of the same surface. So the way that crosses the fewest grey steps is followed, whatever way it turns: the geodesic
distance, by two sweeps to and fro as in a chamfer transform.
Source of the sweeps: Toivanen, New geodesic distance transforms for gray-scale images, Pattern Recognition Letters 17,
1996.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, Int32, Int64, UInt8
from numba import int32, njit

from tangible_core.compiled.compiling import KERNEL

from ..span import UNKNOWN

PER_PIXEL = 1
"""Length of a step to a neighbour of the same grey, in grey levels."""
SWEEPS = (-1, 1)
"""From the last pixel to the first, where what is known lies ahead, and back."""
NO_WAY = np.int32(1 << 28)


class Detours(NamedTuple):
    """For each pixel before the first known one of its row: what the shortest way leads to, and its length."""

    first: Int64[np.ndarray, " h"]
    """The first known column of each row; 0 where there is none, as nothing then tells how far the border reaches."""
    values: Int16[np.ndarray, "h columns"]
    lengths: Int32[np.ndarray, "h columns"]
    """In grey levels."""


def detours(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> Detours:
    """UNKNOWN where no way leads to anything known. disparity is in sixteenths of a pixel."""
    known = disparity != UNKNOWN
    first = known.argmax(axis=1)
    part = slice(None), slice(int(first.max()) + 1)
    values = np.pad(disparity[part], 1, constant_values=UNKNOWN)
    lengths = np.pad(np.where(known[part], np.int32(0), NO_WAY), 1, constant_values=NO_WAY)
    greys = np.pad(grey[part].astype(np.int32), 1)
    for step in SWEEPS:
        _sweep(greys, first, step, values, lengths)
    return Detours(first, values[1:-1, 1:-1], lengths[1:-1, 1:-1])


@njit(**KERNEL)
def _sweep(grey, first, step, values, lengths):
    """All with a margin of one pixel, which no way leads through; nor does any through a gap further on in a row."""
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
