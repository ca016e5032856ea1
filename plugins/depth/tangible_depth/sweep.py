"""Semi-global matching along four paths, one byte a pixel and disparity.

Source: Hirschmueller, Stereo processing by semiglobal matching and mutual information, IEEE PAMI 30(2), 2008, eq. 13.
Each path is kept relative to its own minimum, so that the winner's sum of four paths is small and saturating bytes are
enough: only losers reach 255.

Rows are worked in strips. A strip begins its downward (and upward) path some rows early, which makes strips independent
of each other: any number of threads, bounded memory, and a volume that stays near the processor.

Lane k stands for the disparity top - k, so that the right view's codes are contiguous: for pixel x they begin at
codes[x], a row of w + n - 1 codes of which codes[i] is the right view's column i - top.
"""

from typing import NamedTuple

import numpy as np
from numba import int64, njit, uint8

from .lanes import (
    LanesType,
    first_equal,
    first_lane,
    hamming,
    load,
    lowest,
    maximum,
    minimum,
    saturating_add,
    shift_down,
    shift_up,
    splat,
    store,
    subtract,
    width,
)
from .subpixel import equiangular

UNKNOWN = np.int16(-32768)
"""A disparity that is not known, in maps of sixteenths of a pixel."""
WORST = np.uint8(255)


class Limits(NamedTuple):
    """Bounds on a row's costs: most and least for each index of the shifted right row, and 255 for lanes not asked for."""

    most: np.ndarray
    least: np.ndarray
    barred: np.ndarray
    free: tuple[int, int]
    """Columns first..last - 1, at which no lane has a limit."""


class Span(NamedTuple):
    """The disparities low..high, both included."""

    low: int
    high: int

    @property
    def count(self) -> int:
        """How many disparities."""
        return self.high - self.low + 1

    @property
    def lanes(self) -> int:
        """Lanes that hold them: a power of two, at least 16."""
        return max(16, 1 << (self.count - 1).bit_length())

    def shrunk(self, factor: int) -> "Span":
        """In pixels of a picture made smaller by `factor`, none left out."""
        return self if factor == 1 else Span(self.low // factor, -(-self.high // factor))

    def within(self, width: int) -> "Span":
        """Without disparities that no two columns of a picture of this width can have."""
        low = min(max(self.low, 1 - width), width - 1)
        return Span(low, max(min(self.high, width - 1), low))


@njit(inline="always")
def _step(lanes, before, before_lowest, cost, move, jump):
    """One step of a path: stay, move by one disparity or jump to any, then pay the pixel's own cost."""
    wall = splat(lanes, uint8(255))
    moved = saturating_add(minimum(shift_up(before, wall), shift_down(before, wall)), move)
    jumped = splat(lanes, uint8(before_lowest + jump))
    best = minimum(minimum(before, jumped), moved)
    return saturating_add(cost, subtract(best, splat(lanes, before_lowest)))


@njit(inline="always")
def _limited_cost(lanes, left, codes, x, limits):
    """Hamming distances; neutral where a disparity leads out of the right view, 255 where it is not asked for."""
    cost = minimum(hamming(lanes, left, codes, x), load(lanes, limits.most, x))
    return maximum(maximum(cost, load(lanes, limits.least, x)), load(lanes, limits.barred, 0))


@njit(inline="always")
def _grey_step(grey, x, others, z):
    return abs(int64(grey[x]) - int64(others[z]))


@njit(nogil=True, boundscheck=False)
def _vertical(lanes, left, codes, limits, columns, prices, grey, grey_before, path, path_lowest, costs):
    """The path from the row before, in place; `costs` keeps this row's costs. No limits: None."""
    n = width(lanes)
    move, jumps = splat(lanes, prices.move), prices.jumps
    for x in range(columns[0], columns[1]):
        if limits is None:
            cost = hamming(lanes, left, codes, x)
        else:
            cost = _limited_cost(lanes, left, codes, x, limits)
        store(costs, x * n, cost)
        jump = jumps[_grey_step(grey, x, grey_before, x)]
        here = _step(lanes, load(lanes, path, x * n), path_lowest[x], cost, move, jump)
        path_lowest[x] = lowest(here)
        store(path, x * n, here)


@njit(nogil=True, boundscheck=False)
def _whole_row(lanes, left, codes, limits, prices, grey, grey_before, path, path_lowest, costs):
    """`_vertical` for all columns: the limits are looked up only where there are some."""
    first, last = limits.free
    rest = (prices, grey, grey_before, path, path_lowest, costs)
    _vertical(lanes, left, codes, limits, (0, first), *rest)
    _vertical(lanes, left, codes, None, (first, last), *rest)
    _vertical(lanes, left, codes, limits, (last, grey.size), *rest)


@njit(nogil=True, boundscheck=False)
def _sideways(lanes, prices, grey, costs, path, total):
    """Sums of the path from above and those from both ends of the row. Walking both at once hides their latency."""
    n = width(lanes)
    w = grey.size
    east = west = splat(lanes, uint8(0))
    east_lowest = west_lowest = uint8(0)
    east, east_lowest, west, west_lowest = _half_way(
        lanes, prices, grey, costs, path, total, (0, w // 2), east, east_lowest, west, west_lowest
    )
    if w % 2:
        middle = (w // 2) * n
        store(total, middle, load(lanes, path, middle))
    _half_way(lanes, prices, grey, costs, total, total, (w // 2, w), east, east_lowest, west, west_lowest)


@njit(inline="always")
def _half_way(lanes, prices, grey, costs, so_far, total, steps, east, east_lowest, west, west_lowest):
    n = width(lanes)
    move, jumps = splat(lanes, prices.move), prices.jumps
    w = grey.size
    for x in range(steps[0], steps[1]):
        z = w - 1 - x
        east_jump = jumps[_grey_step(grey, x, grey, max(x - 1, 0))]
        west_jump = jumps[_grey_step(grey, z, grey, min(z + 1, w - 1))]
        east = _step(lanes, east, east_lowest, load(lanes, costs, x * n), move, east_jump)
        west = _step(lanes, west, west_lowest, load(lanes, costs, z * n), move, west_jump)
        east_lowest = lowest(east)
        west_lowest = lowest(west)
        store(total, x * n, saturating_add(load(lanes, so_far, x * n), east))
        store(total, z * n, saturating_add(load(lanes, so_far, z * n), west))
    return east, east_lowest, west, west_lowest


@njit(nogil=True, boundscheck=False)
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


@njit(nogil=True, boundscheck=False, error_model="numpy")
def _accept(n, span, total, best, sums, right_sums, most, tolerance, disparity):
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
        fits = (most[x + k] != 0) & (at < WORST) & (at <= tolerance * np.float32(right_sums[x + k]))
        offset = equiangular(before, at, after) if inner else np.float32(0)
        sixteenths = np.int16(np.floor(16 * (np.float32(span.high - k) - offset) + np.float32(0.5)))
        disparity[x] = sixteenths if fits & (not flat) else UNKNOWN


@njit(nogil=True, boundscheck=False)
def _limits(n, w, span, neutral):
    columns = np.arange(w + n - 1) - span.high
    beyond = (columns < 0) | (columns >= w)
    most = np.where(beyond, uint8(0), uint8(255))
    least = np.where(beyond, neutral, uint8(0))
    count = span.high - span.low + 1
    first = min(max(span.high, 0), w)
    last = min(max(w + span.high - n + 1, first), w) if count == n else first
    return Limits(most, least, np.where(np.arange(n) < count, uint8(0), uint8(255)), (first, last))


@njit(nogil=True, boundscheck=False)
def _shifted(row, w, top, codes):
    """The right view's codes as the lanes want them; beyond the picture its edge is repeated."""
    for plane in range(row.shape[0]):
        for i in range(codes.shape[1]):
            codes[plane, i] = row[plane, min(max(i - top, 0), w - 1)]


@njit(nogil=True, boundscheck=False, cache=True)
def sweep_strip(lanes, left, right, grey, rows, warm, span, prices, tolerance, total, disparity, sums):
    """Disparities in sixteenths of a pixel (UNKNOWN where rejected) and sums of rows[0]..rows[1]-1.

    Parameters: lanes, Lanes(n, planes); left, right uint8 (h, planes, >= w), codes of the two views; grey (h, w) uint8, the left view; warm, rows
    that a path begins early; span, the disparities to try, at most n; prices, a `Prices`; tolerance of the left-right check, 1 being strict; total, scratch of at least (rows, w n) bytes.
    Results: disparity int16 (h, w), sums uint8 (h, w), the winner's cost over the four paths.
    """
    n = width(lanes)
    h, w = grey.shape
    y0, y1 = rows
    limits = _limits(n, w, span, prices.neutral)
    path, path_lowest = np.zeros(w * n, np.uint8), np.zeros(w, np.uint8)
    costs = np.empty(w * n, np.uint8)
    codes = np.empty((right.shape[1], w + n - 1), np.uint8)
    best, right_sums = np.empty(w, np.int64), np.empty(w + n, np.uint8)
    for y in range(max(0, y0 - warm), y1):
        _shifted(right[y], w, span.high, codes)
        above = grey[max(y - 1, 0)]
        _whole_row(lanes, left[y], codes, limits, prices, grey[y], above, path, path_lowest, costs)
        if y >= y0:
            _sideways(lanes, prices, grey[y], costs, path, total[y - y0])
    path[:] = 0
    path_lowest[:] = 0
    last = min(h, y1 + warm)
    for i in range(last - y0):
        y = last - 1 - i
        _shifted(right[y], w, span.high, codes)
        below = grey[min(y + 1, h - 1)]
        _whole_row(lanes, left[y], codes, limits, prices, grey[y], below, path, path_lowest, costs)
        if y < y1:
            _decide(lanes, total[y - y0], path, costs, best, sums[y], right_sums)
            _accept(n, span, costs, best, sums[y], right_sums, limits.most, tolerance, disparity[y])
