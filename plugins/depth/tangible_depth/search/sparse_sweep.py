"""Semi-global matching of a subset of columns and rows, all in memory: enough to estimate a range."""

import numpy as np
from jaxtyping import Int16, UInt8
from numba import uint8

from tangible_core.compiled import KERNEL, inner, njit

from ..dense.span import UNKNOWN, Span
from ..sgm.costs import PLANES, Penalties
from ..sgm.paths import add_horizontal_paths, jump_penalties, jump_penalties_along, limited_cost, row_limits, step
from ..sgm.strips import WORST, begin_path, equiangular, shift_codes
from ..simd.lane_reductions import first_equal, first_lane, lowest
from ..simd.lanes import Lanes, load, minimum, saturating_add, shift_down, splat, store, width

# Fewest lanes; more are a power of two, so that few kernels are compiled, and larger disparities fill them.
FEWEST_LANES = 64


def sweep_columns(
    left: UInt8[np.ndarray, "rows planes whole"],
    right: UInt8[np.ndarray, "rows planes whole"],
    grey: UInt8[np.ndarray, "rows m"],
    span: Span,
    penalties: Penalties,
    stride: int,
    out: Int16[np.ndarray, "rows w"],
) -> None:
    """Match every `stride`-th column into `out`, in sixteenths of a pixel, UNKNOWN where the strict check fails."""
    rows, m = grey.shape
    w = out.shape[1]
    n = max(FEWEST_LANES, 1 << (span.size - 1).bit_length())
    span = Span(span.low, span.low + n - 1)
    even = rows + rows % 2
    shapes = (even, m * n), (even, m * n), (2, m + 1), (1, m * n), m, (PLANES, w + n - 1), w + n + stride
    scratch = tuple(np.empty(shape, np.uint8) for shape in shapes)
    limits = row_limits(n, w, span, penalties.neutral)
    _sweep(Lanes(n, PLANES), left, right, grey, span, limits, penalties, stride, scratch, out)


@njit(**KERNEL)
def _sweep(lanes, left, right, grey, span, limits, penalties, stride, scratch, out):
    rows, w = out.shape
    n = width(lanes)
    costs, total, p2, path, path_lowest, codes, right_sums = scratch
    p1 = penalties.p1
    begin_path(path, path_lowest)
    for y in range(rows):
        shift_codes(right[y], w, span.high, codes)
        for i in range(path_lowest.size):
            store(costs[y], i * n, limited_cost(lanes, left[y], codes, i * stride, limits))
        jump_penalties(penalties, grey[y], grey[max(y - 1, 0)], p2[0])
        _vertical(lanes, p1, p2[0], costs[y], path[0], path_lowest, total[y], True)
    for y in range(0, rows, 2):
        jump_penalties_along(penalties, grey[y], p2[0])
        jump_penalties_along(penalties, grey[min(y + 1, rows - 1)], p2[1])
        upper, lower = total[y], total[y + 1]  # an odd last row is paired with a dummy row
        add_horizontal_paths(lanes, p1, (costs[y], p2[0], upper, upper), (costs[y + 1], p2[1], lower, lower))
    begin_path(path, path_lowest)
    for i in range(rows):
        y = rows - 1 - i
        jump_penalties(penalties, grey[y], grey[min(y + 1, rows - 1)], p2[0])
        _vertical(lanes, p1, p2[0], costs[y], path[0], path_lowest, total[y], False)
        _best_right_sums(lanes, total[y], stride, right_sums)
        _accept(lanes, total[y], span, stride, limits.most, right_sums, out[y])


@inner()
def _vertical(lanes, p1, p2, costs, path, path_lowest, total, first):
    """Step the path from the previous row, in place, and add it to the total, or start the total with it."""
    n = width(lanes)
    p1 = splat(lanes, p1)
    for i in range(path_lowest.size):
        here = step(lanes, load(lanes, path, i * n), path_lowest[i], load(lanes, costs, i * n), p1, p2[i])
        path_lowest[i] = lowest(here)
        store(path, i * n, here)
        store(total, i * n, here if first else saturating_add(load(lanes, total, i * n), here))


@inner()
def _best_right_sums(lanes, total, stride, right_sums):
    n = width(lanes)
    wall = splat(lanes, uint8(255))
    running_lowest = wall  # lowest sums so far of the n right pixels that later left pixels can match
    m = total.size // n
    for i in range(m):
        running_lowest = minimum(running_lowest, load(lanes, total, i * n))
        for j in range(stride):
            right_sums[i * stride + j] = first_lane(running_lowest)
            running_lowest = shift_down(running_lowest, wall)
    for i in range(m * stride, right_sums.size):
        right_sums[i] = first_lane(running_lowest)
        running_lowest = shift_down(running_lowest, wall)


@inner()
def _accept(lanes, sums, span, stride, most, right_sums, disparity):
    """Accept mutual best matches that fit better than both neighbouring disparities, without unpredictable branches."""
    n = width(lanes)
    for i in range(sums.size // n):
        x = i * stride
        here = load(lanes, sums, i * n)
        at = lowest(here)
        k = first_equal(here, at)
        before, after = np.float32(sums[i * n + max(k - 1, 0)]), np.float32(sums[i * n + min(k + 1, n - 1)])
        inner = (k > 0) & (k < n - 1)
        flat = inner & (before == at) & (after == at)
        fits = (most[x + k] != 0) & (at < WORST) & (at <= right_sums[x + k])
        offset = equiangular(before, np.float32(at), after) if inner else np.float32(0)
        sixteenths = np.int16(np.floor(16 * (np.float32(span.high - k) - offset) + np.float32(0.5)))
        for j in range(x, min(x + stride, disparity.size)):
            disparity[j] = sixteenths if fits & (not flat) else UNKNOWN
