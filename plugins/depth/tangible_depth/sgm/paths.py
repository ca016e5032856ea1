"""The paths of semi-global matching: what one row hands on to the next, and one pixel to its neighbours.

Every cost, path and sum is a byte a lane; lane k stands for the disparity top - k.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from numba import int64, uint8

from tangible_core.compiled.compiling import inner

from ..dense.span import Span
from ..simd.lane_reductions import differences, lowest
from ..simd.lanes import load, maximum, minimum, saturating_add, shift_down, shift_up, splat, store, subtract, width


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
def _step(lanes, before, before_lowest, cost, p1, p2):
    """One step of a path: stay, move by one disparity or jump to any, then pay the pixel's own cost."""
    wall = splat(lanes, uint8(255))
    moved = saturating_add(minimum(shift_up(before, wall), shift_down(before, wall)), p1)
    jumped = splat(lanes, uint8(before_lowest + p2))
    best = minimum(minimum(before, jumped), moved)
    return saturating_add(cost, subtract(best, splat(lanes, before_lowest)))


@inner()
def _limited_cost(lanes, left, codes, x, limits):
    """What codes differ by; neutral where a disparity leads out of the right view, 255 where it is not asked for."""
    cost = minimum(differences(lanes, left, codes, x), load(lanes, limits.most, x))
    return maximum(maximum(cost, load(lanes, limits.least, x)), load(lanes, limits.barred, 0))


@inner()
def _grey_step(grey, x, others, z):
    return abs(int64(grey[x]) - int64(others[z]))


@inner()
def _columns(lanes, left, codes, limits, barred, columns, penalties, grey, grey_before, path, path_lowest, costs):
    """The path from the row before, in place; `costs` keeps this row's costs. No limits but `barred`: None."""
    n = width(lanes)
    p1, p2_by_step = splat(lanes, penalties.p1), penalties.p2_by_step
    never = load(lanes, barred, 0)
    for x in range(columns[0], columns[1]):
        if limits is None:  # known to the compiler: the other branch is not there
            cost = maximum(differences(lanes, left, codes, x), never)
        else:
            cost = _limited_cost(lanes, left, codes, x, limits)
        store(costs, x * n, cost)
        p2 = p2_by_step[_grey_step(grey, x, grey_before, x)]
        here = _step(lanes, load(lanes, path, x * n), path_lowest[x], cost, p1, p2)
        path_lowest[x] = lowest(here)
        store(path, x * n, here)


@inner()
def vertical(lanes, left, codes, limits, penalties, grey, grey_before, path, path_lowest, costs):
    """`_columns` for all columns: the limits are looked up only where there are some."""
    first, last = limits.free
    rest = (penalties, grey, grey_before, path, path_lowest, costs)
    _columns(lanes, left, codes, limits, limits.barred, (0, first), *rest)
    _columns(lanes, left, codes, None, limits.barred, (first, last), *rest)
    _columns(lanes, left, codes, limits, limits.barred, (last, grey.size), *rest)


@inner()
def sideways(lanes, penalties, grey, costs, path, total):
    """Sums of the path from above and those from both ends of the row. Walking both at once hides their latency."""
    n = width(lanes)
    w = grey.size
    east = west = splat(lanes, uint8(0))
    east_lowest = west_lowest = uint8(0)
    east, east_lowest, west, west_lowest = _half_way(
        lanes, penalties, grey, costs, path, total, (0, w // 2), east, east_lowest, west, west_lowest
    )
    if w % 2:
        middle = (w // 2) * n
        store(total, middle, load(lanes, path, middle))
    _half_way(lanes, penalties, grey, costs, total, total, (w // 2, w), east, east_lowest, west, west_lowest)


@inner()
def _half_way(lanes, penalties, grey, costs, so_far, total, steps, east, east_lowest, west, west_lowest):
    n = width(lanes)
    p1, p2_by_step = splat(lanes, penalties.p1), penalties.p2_by_step
    w = grey.size
    for x in range(steps[0], steps[1]):
        z = w - 1 - x
        east_p2 = p2_by_step[_grey_step(grey, x, grey, max(x - 1, 0))]
        west_p2 = p2_by_step[_grey_step(grey, z, grey, min(z + 1, w - 1))]
        east = _step(lanes, east, east_lowest, load(lanes, costs, x * n), p1, east_p2)
        west = _step(lanes, west, west_lowest, load(lanes, costs, z * n), p1, west_p2)
        east_lowest = lowest(east)
        west_lowest = lowest(west)
        store(total, x * n, saturating_add(load(lanes, so_far, x * n), east))
        store(total, z * n, saturating_add(load(lanes, so_far, z * n), west))
    return east, east_lowest, west, west_lowest
