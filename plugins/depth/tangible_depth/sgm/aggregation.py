"""Semi-global matching along four paths, one byte a pixel and disparity.

Source: Hirschmueller, Stereo processing by semiglobal matching and mutual information, IEEE PAMI 30(2), 2008, eq. 13.
Each path is kept relative to its own minimum, so that the winner's sum of four paths is small and saturating bytes are
enough: only losers reach 255.

Rows are worked in strips. A strip begins its downward (and upward) path some rows early, which makes strips independent
of each other: any number of threads, bounded memory, and a volume that stays near the processor.

Lane k stands for the disparity top - k, so that the right view's codes are contiguous: for pixel x they begin at
codes[x], a row of w + n - 1 codes of which codes[i] is the right view's column i - top.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from jaxtyping import Int64, UInt8
from numba import njit, uint8

from tangible_core.compiled.compiling import KERNEL, inner

from ..dense.span import UNKNOWN
from ..dense.subpixel import equiangular
from ..simd.lane_reductions import first_equal, first_lane, lowest
from ..simd.lanes import load, minimum, saturating_add, shift_down, splat, store, width
from .paths import sideways, vertical

WORST = np.uint8(255)


class Scratch(NamedTuple):
    """What one sweep at a time writes on."""

    total: UInt8[np.ndarray, "rows w*n"]
    path: UInt8[np.ndarray, "w*n"]
    path_lowest: UInt8[np.ndarray, "w"]
    costs: UInt8[np.ndarray, "w*n"]
    codes: UInt8[np.ndarray, "planes w+n-1"]
    best: Int64[np.ndarray, "w"]
    right_sums: UInt8[np.ndarray, "w+n"]


def scratch(rows: int, w: int, n: int, planes: int) -> Scratch:
    """For strips of at most so many rows of w columns and n lanes, and codes of so many planes."""
    return Scratch(
        np.empty((rows, w * n), np.uint8),
        np.empty(w * n, np.uint8),
        np.empty(w, np.uint8),
        np.empty(w * n, np.uint8),
        np.empty((planes, w + n - 1), np.uint8),
        np.empty(w, np.int64),
        np.empty(w + n, np.uint8),
    )


@inner()
def _begin(path, path_lowest):
    """A path that nothing has been paid for."""
    for i in range(path.size):
        path[i] = 0
    for i in range(path_lowest.size):
        path_lowest[i] = 0


@inner()
def _decide(lanes, total, path, finals, best, sums, right_sums):
    """Add the last path; the best lane and its sum for each left pixel, the best sum for each right pixel."""
    n = width(lanes)
    w = best.size
    wall = splat(lanes, uint8(255))
    seen = wall  # lowest sums so far of the n right pixels that the left pixels still to come can see
    for x in range(w):
        sum_here = saturating_add(load(lanes, total, x * n), load(lanes, path, x * n))
        store(finals, x * n, sum_here)
        seen = minimum(seen, sum_here)
        right_sums[x] = first_lane(seen)
        seen = shift_down(seen, wall)
        sums[x] = lowest(sum_here)
        best[x] = first_equal(sum_here, sums[x])
    for i in range(n - 1):
        right_sums[w + i] = first_lane(seen)
        seen = shift_down(seen, wall)


@inner()
def _accept(n, span, total, best, sums, right_sums, most, check_tolerance, disparity):
    """Disparities that pass the left-right check: no left pixel fits the right pixel better by more than a factor.

    A pixel whose neighbouring disparities fit as well as the best one says nothing and is not accepted. Written without
    branches, because what is accepted no processor can guess.
    """
    count = span.high - span.low + 1
    for x in range(best.size):
        k = best[x]
        at = np.float32(sums[x])
        before = np.float32(total[x * n + max(k - 1, 0)])
        after = np.float32(total[x * n + min(k + 1, n - 1)])
        inner = (k > 0) & (k < count - 1)
        flat = inner & (before == at) & (after == at)
        fits = (most[x + k] != 0) & (at < WORST) & (at <= check_tolerance * np.float32(right_sums[x + k]))
        offset = equiangular(before, at, after) if inner else np.float32(0)
        sixteenths = np.int16(np.floor(16 * (np.float32(span.high - k) - offset) + np.float32(0.5)))
        disparity[x] = sixteenths if fits & (not flat) else UNKNOWN


@inner()
def _shifted(row, w, top, codes):
    """The right view's codes as the lanes want them; beyond the picture its edge is repeated."""
    for plane in range(row.shape[0]):
        for i in range(codes.shape[1]):
            codes[plane, i] = row[plane, min(max(i - top, 0), w - 1)]


@njit(**KERNEL)
def sweep_strip(lanes, left, right, grey, rows, warm, span, limits, prices, check_tolerance, scratch, disparity, sums):
    """Disparities in sixteenths of a pixel (UNKNOWN where rejected) and sums of rows[0]..rows[1]-1.

    Parameters: lanes, Lanes(n, planes); left, right uint8 (h, planes, >= w), codes of the two views; grey uint8 (h, w),
    the left view; warm, rows that a path begins early; span, the disparities to try, at most n; limits, those of rows
    of w columns; prices, a `Prices`; check_tolerance of the left-right check, 1 being strict; scratch, for at least as
    many rows. Results: disparity int16 (h, w), sums uint8 (h, w), the winner's cost over the four paths.
    """
    h, w = grey.shape
    y0, y1 = rows
    total, path, path_lowest, costs, codes, best, right_sums = scratch
    _begin(path, path_lowest)
    for y in range(max(0, y0 - warm), y1):
        _shifted(right[y], w, span.high, codes)
        above = grey[max(y - 1, 0)]
        vertical(lanes, left[y], codes, limits, prices, grey[y], above, path, path_lowest, costs)
        if y >= y0:
            sideways(lanes, prices, grey[y], costs, path, total[y - y0])
    _begin(path, path_lowest)
    last = min(h, y1 + warm)
    for i in range(last - y0):
        y = last - 1 - i
        _shifted(right[y], w, span.high, codes)
        below = grey[min(y + 1, h - 1)]
        vertical(lanes, left[y], codes, limits, prices, grey[y], below, path, path_lowest, costs)
        if y < y1:
            _decide(lanes, total[y - y0], path, costs, best, sums[y], right_sums)
            _accept(width(lanes), span, costs, best, sums[y], right_sums, limits.most, check_tolerance, disparity[y])
