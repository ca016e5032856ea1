"""The paths of semi-global matching; a cost is a byte a lane, and lane k stands for the disparity top - k."""

from typing import NamedTuple

import numpy as np
from numba import int64, uint8, uint64

from tangible_core.compiled import inner

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
    """Bounds on a row's costs: most and least by index of the shifted right row; `unused` is 255 for unused lanes."""

    most: np.ndarray
    least: np.ndarray
    unused: np.ndarray
    free: tuple[int, int]  # columns first..last - 1, at which only unused lanes have a limit


def row_limits(n: int, w: int, span: Span, neutral: np.uint8) -> Limits:
    """Compute the limits of rows of w columns."""
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
    """Step a path by one pixel: stay, move by one disparity or jump to any, then add the pixel's own cost."""
    wall = splat(lanes, uint8(255))
    neighbour = saturating_add(minimum(shift_up(before, wall), shift_down(before, wall)), p1)
    least = splat(lanes, before_lowest)
    jump = add(least, splat(lanes, p2))
    best = minimum(minimum(before, neighbour), jump)
    return saturating_add(cost, subtract(best, least))


@inner()
def limited_cost(lanes, left, codes, x, limits):
    """Count the differing bits of codes; neutral if a disparity leads out of the right view, 255 for unused lanes."""
    cost = minimum(differences(lanes, left, codes, x), load(lanes, limits.most, x))
    return maximum(maximum(cost, load(lanes, limits.least, x)), load(lanes, limits.unused, 0))


@inner()
def jump_penalties(penalties, row, other, p2):
    """Write the penalty P2 of a jump from each pixel of a row to the same column of another."""
    for x in range(row.size):
        p2[x] = penalties.p2_by_step[uint64(abs(int64(row[x]) - int64(other[x])))]


@inner()
def jump_penalties_along(penalties, row, p2):
    """Write the penalty P2 of a jump from column x - 1 of a row to column x, and at either end."""
    jump_penalties(penalties, row[1:], row[: row.size - 1], p2[1:])
    p2[0] = p2[row.size] = penalties.p2_by_step[0]


@inner()
def _step_columns(lanes, left, codes, limits, unused, columns, p1, p2, before, path, path_lowest, costs):
    """Step the path from the previous row; `costs` keeps this row's costs. limits: None for `unused` alone."""
    n = width(lanes)
    p1, never = splat(lanes, p1), load(lanes, unused, 0)
    for x in range(columns[0], columns[1]):
        if limits is None:  # a compile-time constant: the other branch is removed
            cost = maximum(differences(lanes, left, codes, x), never)
        else:
            cost = limited_cost(lanes, left, codes, x, limits)
        store(costs, x * n, cost)
        i = uint64(x)  # never negative, which spares numba a test
        here = step(lanes, load(lanes, before, x * n), path_lowest[i], cost, p1, p2[i])
        path_lowest[i] = lowest(here)
        store(path, x * n, here)


@inner()
def step_vertical_path(lanes, left, codes, limits, p1, p2, before, path, path_lowest, costs):
    """Run `_step_columns` for all columns, with limits only for the columns that have some."""
    first, last = limits.free
    rest = (p1, p2, before, path, path_lowest, costs)
    _step_columns(lanes, left, codes, limits, limits.unused, (0, first), *rest)
    _step_columns(lanes, left, codes, None, limits.unused, (first, last), *rest)
    _step_columns(lanes, left, codes, limits, limits.unused, (last, path_lowest.size), *rest)


@inner()
def add_horizontal_paths(lanes, p1, upper, lower):
    """Add the paths from both ends of two rows (costs, `jump_penalties_along`, path, total) to those from above."""
    n = width(lanes)
    w = upper[1].size - 1
    nothing = splat(lanes, uint8(0)), uint8(0), splat(lanes, uint8(0)), uint8(0)
    # Interleaving all four paths hides their latency.
    ends = _walk_half(lanes, p1, upper, lower, (0, w // 2), nothing, nothing)
    if w % 2:
        middle = (w // 2) * n
        for _, _, path, total in (upper, lower):
            store(total, middle, load(lanes, path, middle))
    _walk_half(lanes, p1, _continue_total(upper), _continue_total(lower), (w // 2, w), *ends)


@inner()
def _continue_total(row):
    """Return the row with its total in place of the path, to add the rest to it."""
    costs, p2, _, total = row
    return costs, p2, total, total


@inner()
def _walk_half(lanes, p1, upper, lower, steps, upper_ends, lower_ends):
    p1 = splat(lanes, p1)
    for x in range(steps[0], steps[1]):
        upper_ends = _step_inward(lanes, p1, upper, x, upper_ends)
        lower_ends = _step_inward(lanes, p1, lower, x, lower_ends)
    return upper_ends, lower_ends


@inner()
def _step_inward(lanes, p1, row, x, ends):
    """Step the paths from both ends of a row: to column x, and to the same distance from the other end."""
    n = width(lanes)
    costs, p2, before, total = row
    east, east_lowest, west, west_lowest = ends
    z = p2.size - 2 - x
    east = step(lanes, east, east_lowest, load(lanes, costs, x * n), p1, p2[uint64(x)])
    west = step(lanes, west, west_lowest, load(lanes, costs, z * n), p1, p2[uint64(z + 1)])
    store(total, x * n, saturating_add(load(lanes, before, x * n), east))
    store(total, z * n, saturating_add(load(lanes, before, z * n), west))
    return east, lowest(east), west, lowest(west)
