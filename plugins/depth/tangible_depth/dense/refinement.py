"""From raw matches to a dense map: cleaned, filled, sharpened, enlarged.

What looks only a few rows away is done block by block, all of it by the thread that has the block: a block is cut out
with some rows to spare, treated like a picture of its own, and its own rows are kept.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32, Int16, UInt8
from numba import int32, njit

from tangible_core.compiled.compiling import KERNEL, inner
from tangible_core.compiled.threads import in_blocks
from tangible_core.data import DisparityMap

from .confidence import FILLED, FLAT_REACH, GAP_REACH, STEP_REACH, confidence, flat_pixels
from .edges import MEDIAN_REACH, VOTERS, median, sharpen_edges
from .filling.gaps import Effort, fill_gaps
from .span import UNKNOWN
from .speckles import Specks, remove_specks

SAME_SURFACE = 16
"""Sixteenths of a pixel that two neighbours of a small map may differ by and still be blended when it is enlarged."""


class DenseMatches(NamedTuple):
    """Disparity in sixteenths of a pixel, and its confidence."""

    disparity: Int16[np.ndarray, "h w"]
    confidence: Float32[np.ndarray, "h w"]


class Cleaning(NamedTuple):
    """What is done to raw matches besides the rest."""

    sharpen: bool = True
    """Edges are sharpened; a map that will be enlarged is sharpened then."""
    specks: Specks = Specks()
    """Which islands are errors, in a picture of full size."""
    factor: int = 1
    """By how much the picture was made smaller."""
    effort: Effort = "balanced"
    """How gaps are filled (`fill_gaps`)."""


def _empty(shape: tuple[int, int]) -> DenseMatches:
    return DenseMatches(np.empty(shape, np.int16), np.empty(shape, np.float32))


def completed(
    matched: Int16[np.ndarray, "h w"],
    quality: UInt8[np.ndarray, "h w"],
    by_quality: Float[np.ndarray, "256"],
    grey: UInt8[np.ndarray, "h w"],
    cleaning: Cleaning | None = None,
) -> DenseMatches:
    """Speckles removed (in `matched` itself), gaps filled, edges sharpened, and all of it judged (see `confidence`).

    A map without any match stays UNKNOWN.
    """
    cleaning = cleaning or Cleaning()
    remove_specks(matched, cleaning.specks, cleaning.factor)
    filled = fill_gaps(matched, grey, cleaning.effort)
    out = _empty(grey.shape)

    def block(y0: int, y1: int) -> None:
        cut, own = _with_margin(y0, y1, 2 * MEDIAN_REACH + VOTERS + max(STEP_REACH, GAP_REACH))
        final = median(filled[cut])
        if cleaning.sharpen:
            final = median(sharpen_edges(final, grey[cut]))
        out.disparity[y0:y1] = final[own]
        out.confidence[y0:y1] = confidence(matched[cut], final, quality[cut], by_quality)[own]

    in_blocks(grey.shape[0], block)
    return out


def enlarged(small: DenseMatches, grey: UInt8[np.ndarray, "h w"]) -> DenseMatches:
    """Twice the size: linear within a surface, and at its edges decided by the larger picture `grey`."""
    out = _empty(grey.shape)
    padded = np.pad(small.disparity, 1, mode="edge")

    def block(y0: int, y1: int) -> None:
        cut, own = _with_margin(y0, y1, VOTERS)
        part = _empty(grey[cut].shape)
        _enlarge(padded, small.confidence, cut.start, *part)
        out.disparity[y0:y1] = sharpen_edges(part.disparity, grey[cut])[own]
        out.confidence[y0:y1] = part.confidence[own]

    in_blocks(grey.shape[0], block)
    return out


def as_map(dense: DenseMatches, grey: UInt8[np.ndarray, "h w"], fill: bool) -> DisparityMap:
    """In pixels; NaN where nothing is known and, unless `fill`, where a value comes from neighbours."""
    disparity_px, trust = np.empty(grey.shape, np.float32), np.empty(grey.shape, np.float32)

    def block(y0: int, y1: int) -> None:
        cut, own = _with_margin(y0, y1, FLAT_REACH)
        rows = (each[y0:y1] for each in (*dense, disparity_px, trust))
        _to_pixels(flat_pixels(grey[cut])[own], fill, *rows)

    in_blocks(grey.shape[0], block)
    return DisparityMap(disparity_px, trust)


def _with_margin(y0: int, y1: int, rows: int) -> tuple[slice, slice]:
    """Rows y0..y1-1 with as many more on either side, or as there are; and where among these the former lie."""
    first = max(0, y0 - rows)
    return slice(first, y1 + rows), slice(y0 - first, y1 - first)


@njit(**KERNEL)
def _to_pixels(flat, fill, disparity, confidence, disparity_px, trust):
    for y in range(disparity.shape[0]):
        for x in range(disparity.shape[1]):
            value = np.float32(0) if flat[y, x] else confidence[y, x]
            known = disparity[y, x] != UNKNOWN and (fill or value > np.float32(FILLED))
            trust[y, x] = value if known else np.float32(0)
            disparity_px[y, x] = np.float32(disparity[y, x]) * np.float32(1 / 16) if known else np.float32(np.nan)


@njit(**KERNEL)
def _enlarge(padded, trust, y0, out, out_trust):
    """Rows from y0 on; `padded` is the small map with its edge repeated once.

    A pixel lies a quarter of a small pixel off the centre of its own: 3/4 of that, 1/4 of the neighbour there.
    """
    for i in range(out.shape[0]):
        y = y0 + i
        near, other = padded[(y >> 1) + 1], padded[(y >> 1) + 2 * (y & 1)]
        for odd in range(2):  # every other column, so that neither loop has a branch
            for x in range((out.shape[1] + 1 - odd) >> 1):
                own = int32(near[x + 1])
                total = 4 * own + _step(own, near[x + 2 * odd]) + _step(own, other[x + 1])
                out[i, 2 * x + odd] = UNKNOWN if own == UNKNOWN else min(total >> 1, 32767)
                out_trust[i, 2 * x + odd] = trust[y >> 1, x]


@inner()
def _step(own, other):
    """To a neighbour on the same surface; 0 to any other."""
    step = int32(other) - own
    return step if abs(step) <= SAME_SURFACE else int32(0)
