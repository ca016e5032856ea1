"""The paths of semi-global matching: what one row hands on to the next, and one pixel to its neighbours.

Every cost, path and sum is a byte a lane; lane k stands for the disparity top - k.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from numba import int64, uint8, uint64

from tangible_core.compiled.compiling import inner

from ..dense.span import Span
from ..simd.lane_reductions import differences, lowest
from ..simd.lanes import (
    add,
    load,
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


class Limits(NamedTuple):
    """Bounds on a row's costs: most and least by index of the shifted right row, 255 for lanes not asked for."""

    most: np.ndarray
    least: np.ndarray
    barred: np.ndarray
    free: tuple[int, int]
    """Columns first..last - 1, at which only lanes that are not asked for have a limit."""


def limits_of(n: int, w: int, span: Span, neutral: np.uint8) -> Limits:
    """The limits of rows of w columns."""
    columns = np.arange(w + n - 1) - span.high
    beyond = (columns < 0) | (columns >= w)
    first = min(max(span.high, 0), w)
    last = min(max(w + span.high - n + 1, first), w)
    return Limits(
        np.where(beyond, np.uint8(0), np.uint8(255)),
        np.where(beyond, neutral, np.uint8(0)),
        np.where(np.arange(n) < span.size, np.uint8(0), np.uint8(255)),
        (first, last),
    )


@inner()
def step(lanes, before, before_lowest, cost, p1, p2):
    """One step of a path: stay, move by one disparity or jump to any, then pay the pixel's own cost."""
    wall = splat(lanes, uint8(255))
    moved = saturating_add(minimum(shift_up(before, wall), shift_down(before, wall)), p1)
    least = splat(lanes, before_lowest)
    jumped = add(least, splat(lanes, p2))
    best = minimum(minimum(before, moved), jumped)
    return saturating_add(cost, subtract(best, least))


@inner()
def _limited_cost(lanes, left, codes, x, limits):
    """What codes differ by; neutral where a disparity leads out of the right view, 255 where it is not asked for."""
    cost = minimum(differences(lanes, left, codes, x), load(lanes, limits.most, x))
    return maximum(maximum(cost, load(lanes, limits.least, x)), load(lanes, limits.barred, 0))


@inner()
def jumps(penalties, row, other, p2):
    """What a jump costs from each pixel of a row to the one beside it in another."""
    for x in range(row.size):
        p2[x] = penalties.p2_by_step[uint64(abs(int64(row[x]) - int64(other[x])))]


@inner()
def jumps_along(penalties, row, p2):
    """What a jump costs from column x - 1 of a row to column x, and at either end."""
    jumps(penalties, row[1:], row[: row.size - 1], p2[1:])
    p2[0] = p2[row.size] = penalties.p2_by_step[0]


@inner()
def _columns(lanes, left, codes, limits, barred, columns, p1, p2, before, path, path_lowest, costs):
    """The path from the row before; `costs` keeps this row's costs. No limits but `barred`: None."""
    n = width(lanes)
    p1, never = splat(lanes, p1), load(lanes, barred, 0)
    for x in range(columns[0], columns[1]):
        if limits is None:  # known to the compiler: the other branch is not there
            cost = maximum(differences(lanes, left, codes, x), never)
        else:
            cost = _limited_cost(lanes, left, codes, x, limits)
        store(costs, x * n, cost)
        i = uint64(x)  # never negative, and numba need not ask
        here = step(lanes, load(lanes, before, x * n), path_lowest[i], cost, p1, p2[i])
        path_lowest[i] = lowest(here)
        store(path, x * n, here)


@inner()
def vertical(lanes, left, codes, limits, p1, p2, before, path, path_lowest, costs):
    """`_columns` for all columns: the limits are looked up only where there are some."""
    first, last = limits.free
    rest = (p1, p2, before, path, path_lowest, costs)
    _columns(lanes, left, codes, limits, limits.barred, (0, first), *rest)
    _columns(lanes, left, codes, None, limits.barred, (first, last), *rest)
    _columns(lanes, left, codes, limits, limits.barred, (last, path_lowest.size), *rest)


@inner()
def sideways(lanes, p1, upper, lower):
    """Of two rows: sums of the path from above and those from both ends. Walking all four at once hides their latency.

    upper, lower: costs, `jumps_along`, path and total of a row.
    """
    n = width(lanes)
    w = upper[1].size - 1
    nothing = splat(lanes, uint8(0)), uint8(0), splat(lanes, uint8(0)), uint8(0)
    ends = _half_way(lanes, p1, upper, lower, (0, w // 2), nothing, nothing)
    if w % 2:
        middle = (w // 2) * n
        for _, _, path, total in (upper, lower):
            store(total, middle, load(lanes, path, middle))
    _half_way(lanes, p1, _begun(upper), _begun(lower), (w // 2, w), *ends)


@inner()
def _begun(row):
    """The row, to whose total more is to be added."""
    costs, p2, _, total = row
    return costs, p2, total, total


@inner()
def _half_way(lanes, p1, upper, lower, steps, upper_ends, lower_ends):
    p1 = splat(lanes, p1)
    for x in range(steps[0], steps[1]):
        upper_ends = _inward(lanes, p1, upper, x, upper_ends)
        lower_ends = _inward(lanes, p1, lower, x, lower_ends)
    return upper_ends, lower_ends


@inner()
def _inward(lanes, p1, row, x, ends):
    """One step of the paths from both ends of a row: to column x, and as far from the other end."""
    n = width(lanes)
    costs, p2, so_far, total = row
    east, east_lowest, west, west_lowest = ends
    z = p2.size - 2 - x
    east = step(lanes, east, east_lowest, load(lanes, costs, x * n), p1, p2[uint64(x)])
    west = step(lanes, west, west_lowest, load(lanes, costs, z * n), p1, p2[uint64(z + 1)])
    store(total, x * n, saturating_add(load(lanes, so_far, x * n), east))
    store(total, z * n, saturating_add(load(lanes, so_far, z * n), west))
    return east, lowest(east), west, lowest(west)
