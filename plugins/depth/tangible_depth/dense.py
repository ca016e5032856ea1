"""From raw matches to a dense map: cleaned, filled, sharpened, enlarged."""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32, Int16, UInt8
from numba import int32, njit

from tangible_core.data import DisparityMap
from tangible_core.threads import in_blocks

from .confidence import FILLED, confidence, flat_pixels
from .edges import median, sharpen_edges
from .filling import fill
from .span import UNKNOWN
from .speckles import remove_speckles

SAME_SURFACE = 16
"""Sixteenths of a pixel that two neighbours of a small map may differ by and still be blended when it is enlarged."""


class Dense(NamedTuple):
    """Disparity in sixteenths of a pixel, and its confidence."""

    disparity: Int16[np.ndarray, "h w"]
    confidence: Float32[np.ndarray, "h w"]


def completed(
    matched: Int16[np.ndarray, "h w"],
    quality: UInt8[np.ndarray, "h w"],
    by_quality: Float[np.ndarray, "256"],
    grey: UInt8[np.ndarray, "h w"],
    sharpen: bool = True,
) -> Dense:
    """Speckles removed (in `matched` itself), gaps filled, edges sharpened, and all of it judged (see `confidence`).

    A map without any match stays UNKNOWN. Not to `sharpen` is for a map that will be enlarged, and sharpened then.
    """
    remove_speckles(matched)
    if (matched == UNKNOWN).all():
        return Dense(matched, np.zeros(matched.shape, np.float32))
    final = median(fill(matched, grey))
    if sharpen:
        final = median(sharpen_edges(final, grey))
    return Dense(final, confidence(matched, final, quality, by_quality))


def enlarged(small: Dense, grey: UInt8[np.ndarray, "h w"]) -> Dense:
    """Twice the size: linear within a surface, and at its edges decided by the larger picture `grey`."""
    h, w = grey.shape
    disparity = np.empty((h, w), np.int16)
    in_blocks(h, lambda a, b: _enlarge(small.disparity, a, b, disparity))
    trust = np.repeat(np.repeat(small.confidence, 2, 0), 2, 1)[:h, :w]
    return Dense(sharpen_edges(disparity, grey), trust)


def as_map(dense: Dense, grey: UInt8[np.ndarray, "h w"], fill: bool) -> DisparityMap:
    """In pixels; NaN where nothing is known and, unless `fill`, where a value comes from neighbours."""
    flat = flat_pixels(grey)
    disparity_px, trust = np.empty(grey.shape, np.float32), np.empty(grey.shape, np.float32)
    in_blocks(grey.shape[0], lambda a, b: _to_pixels(*dense, flat, fill, a, b, disparity_px, trust))
    return DisparityMap(disparity_px, trust)


@njit(nogil=True, boundscheck=False, cache=True)
def _to_pixels(disparity, confidence, flat, fill, y0, y1, disparity_px, trust):
    for y in range(y0, y1):
        for x in range(disparity.shape[1]):
            value = np.float32(0) if flat[y, x] else confidence[y, x]
            known = disparity[y, x] != UNKNOWN and (fill or value > np.float32(FILLED))
            trust[y, x] = value if known else np.float32(0)
            disparity_px[y, x] = np.float32(disparity[y, x]) * np.float32(1 / 16) if known else np.float32(np.nan)


@njit(nogil=True, boundscheck=False, cache=True)
def _enlarge(small, y0, y1, out):
    """A pixel lies a quarter of a small pixel off the centre of its own: 3/4 of that, 1/4 of the neighbour there."""
    h, w = small.shape
    for y in range(y0, y1):
        other_row = min(max((y >> 1) + (1 if y & 1 else -1), 0), h - 1)
        for x in range(out.shape[1]):
            own = int32(small[y >> 1, x >> 1])
            if own == UNKNOWN:
                out[y, x] = UNKNOWN
                continue
            across = int32(small[y >> 1, min(max((x >> 1) + (1 if x & 1 else -1), 0), w - 1)])
            down = int32(small[other_row, x >> 1])
            total = 4 * own
            if abs(across - own) <= SAME_SURFACE:
                total += across - own
            if abs(down - own) <= SAME_SURFACE:
                total += down - own
            out[y, x] = min(total >> 1, 32767)
