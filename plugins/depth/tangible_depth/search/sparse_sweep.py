"""Semi-global matching of every few columns of rows that lie far apart: all that telling a range needs.

As `sgm.aggregation`, but all rows fit into memory: costs are counted once, and two rows are walked along at a time.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int64, njit, uint8

from tangible_core.compiled.compiling import KERNEL, inner

from ..dense.span import UNKNOWN, Span
from ..dense.subpixel import equiangular
from ..sgm.census import PLANES
from ..sgm.costs import Penalties
from ..sgm.paths import _step as step
from ..simd.lane_reductions import differences, first_equal, first_lane, lowest
from ..simd.lanes import Lanes, load, maximum, minimum, saturating_add, shift_down, splat, store, width

WORST = np.uint8(255)
FEWEST_LANES = 64
"""Lanes are a power of two from here on, so that few kernels are compiled; larger disparities fill them."""


class _Scratch(NamedTuple):
    costs: UInt8[np.ndarray, "rows m*n"]
    total: UInt8[np.ndarray, "rows m*n"]
    path: UInt8[np.ndarray, "m*n"]
    path_lowest: UInt8[np.ndarray, "m"]
    codes: UInt8[np.ndarray, "planes w+n-1"]
    bounds: UInt8[np.ndarray, "2 w+n-1"]
    right_sums: UInt8[np.ndarray, "w+n+stride"]


def sweep_columns(
    left: UInt8[np.ndarray, "rows planes whole"],
    right: UInt8[np.ndarray, "rows planes whole"],
    grey: UInt8[np.ndarray, "rows m"],
    span: Span,
    penalties: Penalties,
    stride: int,
    out: Int16[np.ndarray, "rows w"],
) -> None:
    """Disparities in sixteenths of a pixel, UNKNOWN where the strict left-right check fails.

    left, right: census codes. grey: of the columns that are matched, every `stride`-th, each of which speaks for the
    columns up to the next.
    """
    rows, m = grey.shape
    w = out.shape[1]
    n = max(FEWEST_LANES, 1 << (span.size - 1).bit_length())
    span = Span(span.low, span.low + n - 1)
    scratch = _Scratch(
        np.empty((rows, m * n), np.uint8),
        np.empty((rows, m * n), np.uint8),
        np.empty(m * n, np.uint8),
        np.empty(m, np.uint8),
        np.empty((PLANES, w + n - 1), np.uint8),
        np.empty((2, w + n - 1), np.uint8),
        np.empty(w + n + stride, np.uint8),
    )
    _sweep(Lanes(n, PLANES), left, right, grey, span, penalties, stride, scratch, out)


@njit(**KERNEL)
def _sweep(lanes, left, right, grey, span, penalties, stride, scratch, out):
    rows, w = out.shape
    costs, total, path, path_lowest, codes, bounds, right_sums = scratch
    _bounds(w, span.high, penalties.neutral, bounds)
    _begin(path, path_lowest)
    for y in range(rows):
        _shifted(right[y], w, span.high, codes)
        _count(lanes, left[y], codes, bounds, stride, costs[y])
        _vertical(lanes, penalties, grey[y], grey[max(y - 1, 0)], costs[y], path, path_lowest, total[y], True)
    for y in range(0, rows, 2):
        _sideways(lanes, penalties, grey, costs, total, y, min(y + 1, rows - 1))
    _begin(path, path_lowest)
    for i in range(rows):
        y = rows - 1 - i
        _vertical(lanes, penalties, grey[y], grey[min(y + 1, rows - 1)], costs[y], path, path_lowest, total[y], False)
        _best_right_sums(lanes, total[y], stride, right_sums)
        _accept(lanes, total[y], span, stride, bounds, right_sums, out[y])


@inner()
def _begin(path, path_lowest):
    """A path that nothing has been paid for."""
    for i in range(path.size):
        path[i] = 0
    for i in range(path_lowest.size):
        path_lowest[i] = 0


@inner()
def _bounds(w, top, neutral, bounds):
    """What a column of the right view costs at most and at least: neutral beyond the picture."""
    for i in range(bounds.shape[1]):
        beyond = (i < top) | (i >= top + w)
        bounds[0, i] = uint8(0) if beyond else uint8(255)
        bounds[1, i] = neutral if beyond else uint8(0)


@inner()
def _shifted(row, w, top, codes):
    """The right view's codes as the lanes want them; beyond the picture its edge is repeated."""
    for plane in range(row.shape[0]):
        for i in range(codes.shape[1]):
            codes[plane, i] = row[plane, min(max(i - top, 0), w - 1)]


@inner()
def _count(lanes, left, codes, bounds, stride, costs):
    """What codes differ by; neutral where a disparity leads out of the right view."""
    n = width(lanes)
    for i in range(costs.size // n):
        x = i * stride
        cost = minimum(differences(lanes, left, codes, x), load(lanes, bounds[0], x))
        store(costs, i * n, maximum(cost, load(lanes, bounds[1], x)))


@inner()
def _vertical(lanes, penalties, grey, grey_before, costs, path, path_lowest, total, first):
    """The path from the row before, in place; added to the total, of which it may be the first part."""
    n = width(lanes)
    p1, p2_by_step = splat(lanes, penalties.p1), penalties.p2_by_step
    for i in range(grey.size):
        p2 = p2_by_step[_grey_step(grey[i], grey_before[i])]
        here = step(lanes, load(lanes, path, i * n), path_lowest[i], load(lanes, costs, i * n), p1, p2)
        path_lowest[i] = lowest(here)
        store(path, i * n, here)
        store(total, i * n, here if first else saturating_add(load(lanes, total, i * n), here))


@inner()
def _sideways(lanes, penalties, grey, costs, total, upper, lower):
    """The paths from both ends of two rows, added to their totals: four at once hide their latency."""
    n = width(lanes)
    m = grey.shape[1]
    p1, p2_by_step = splat(lanes, penalties.p1), penalties.p2_by_step
    start = splat(lanes, uint8(0))
    east = west = east_below = west_below = start
    a = b = c = d = uint8(0)
    for x in range(m):
        z = m - 1 - x
        before, after = max(x - 1, 0), min(z + 1, m - 1)
        p2 = p2_by_step[_grey_step(grey[upper, x], grey[upper, before])]
        east = step(lanes, east, a, load(lanes, costs[upper], x * n), p1, p2)
        p2 = p2_by_step[_grey_step(grey[upper, z], grey[upper, after])]
        west = step(lanes, west, b, load(lanes, costs[upper], z * n), p1, p2)
        p2 = p2_by_step[_grey_step(grey[lower, x], grey[lower, before])]
        east_below = step(lanes, east_below, c, load(lanes, costs[lower], x * n), p1, p2)
        p2 = p2_by_step[_grey_step(grey[lower, z], grey[lower, after])]
        west_below = step(lanes, west_below, d, load(lanes, costs[lower], z * n), p1, p2)
        a, b, c, d = lowest(east), lowest(west), lowest(east_below), lowest(west_below)
        _add(lanes, total[upper], x * n, east)
        _add(lanes, total[upper], z * n, west)
        if lower != upper:
            _add(lanes, total[lower], x * n, east_below)
            _add(lanes, total[lower], z * n, west_below)


@inner()
def _add(lanes, total, at, path):
    store(total, at, saturating_add(load(lanes, total, at), path))


@inner()
def _grey_step(here, there):
    return abs(int64(here) - int64(there))


@inner()
def _best_right_sums(lanes, total, stride, right_sums):
    """For each right pixel the lowest sum of all left ones that are matched."""
    n = width(lanes)
    wall = splat(lanes, uint8(255))
    seen = wall  # lowest sums so far of the n right pixels that the left pixels still to come can see
    m = total.size // n
    for i in range(m):
        seen = minimum(seen, load(lanes, total, i * n))
        for j in range(stride):
            right_sums[i * stride + j] = first_lane(seen)
            seen = shift_down(seen, wall)
    for i in range(m * stride, right_sums.size):
        right_sums[i] = first_lane(seen)
        seen = shift_down(seen, wall)


@inner()
def _accept(lanes, sums, span, stride, bounds, right_sums, disparity):
    """Mutual best matches that neither neighbouring disparity fits as well as, between the ends of the span.

    Written without branches, because what is accepted no processor can guess.
    """
    n = width(lanes)
    for i in range(sums.size // n):
        x = i * stride
        here = load(lanes, sums, i * n)
        at = lowest(here)
        k = first_equal(here, at)
        before, after = np.float32(sums[i * n + max(k - 1, 0)]), np.float32(sums[i * n + min(k + 1, n - 1)])
        inner = (k > 0) & (k < n - 1)
        flat = inner & (before == at) & (after == at)
        fits = (bounds[0, x + k] != 0) & (at < WORST) & (at <= right_sums[x + k])
        offset = equiangular(before, np.float32(at), after) if inner else np.float32(0)
        sixteenths = np.int16(np.floor(16 * (np.float32(span.high - k) - offset) + np.float32(0.5)))
        for j in range(x, min(x + stride, disparity.size)):
            disparity[j] = sixteenths if fits & (not flat) else UNKNOWN
