"""Matches in a few bands of rows at full width: enough for the search range, and to check that rows correspond."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, Int64, UInt8
from numba import uint8

from tangible_core.compiled import KERNEL, inner, njit

from ..dense.confidence import FLAT_REACH
from ..dense.span import UNKNOWN, Span
from ..dense.speckles import remove_speckles
from ..sgm.costs import BLOCK, OFFSETS, PLANES, RADIUS, SHARP, Penalties, code_rows
from ..sgm.paths import add_horizontal_paths, jump_penalties, jump_penalties_along, limited_cost, row_limits, step
from ..sgm.strips import WORST, begin_path, equiangular, shift_codes
from ..simd.lane_reductions import first_equal, first_lane, lowest
from ..simd.lanes import Lanes, load, minimum, saturating_add, shift_down, splat, store, width
from .pairs import Pair

COUNT = 16
FINE_WIDTH = 1280
# Largest number of disparities tried in a band: of more, columns are averaged.
MAX_DISPARITIES = 256
HIGH_PX = 3  # rows of the picture averaged into one row of a band
TALL = 2 * RADIUS + 1  # rows of a band: the window of a census code
STRIDE = 3
MIN_STRIDDEN = 200
# Largest speckle, in pixels of the bands: thin near objects have hardly more in so few rows.
LARGEST_SPECK = 8
# Fewest lanes; more are a power of two, so that few kernels are compiled, and larger disparities fill them.
FEWEST_LANES = 64


class Bands(NamedTuple):
    """The matches in a few bands, in sixteenths of a pixel of the picture downsampled by `factor` along its rows."""

    rows: Int64[np.ndarray, "bands"]
    disparity: Int16[np.ndarray, "bands columns"]
    factor: int
    match_count: int
    loss: float


def match_bands(pair: Pair, span: Span, width: int = FINE_WIDTH) -> Bands:
    """Match COUNT bands of a pair; columns are averaged until a band is at most `width` wide."""
    # Thin near objects keep their width along a row, and a band of rows averages noise and small row offsets away.
    factor = max(-(-pair.width // width), -(-span.size // MAX_DISPARITIES))
    columns = -(-pair.width // factor)
    # The columns next to a matched one take its disparity.
    stride = STRIDE if columns >= MIN_STRIDDEN else 1
    rows = np.empty(COUNT, np.int64)
    codes = np.empty((2, COUNT, PLANES, columns + -columns % BLOCK), np.uint8)
    grey = np.empty((COUNT, -(-columns // stride)), np.uint8)
    flat = np.empty((COUNT, columns), np.bool_)
    total = np.empty(columns * factor, np.int32)
    band = np.empty((TALL, codes.shape[3] + 2 * RADIUS), np.uint8)
    _encode_bands(pair.left, pair.right, factor, OFFSETS, stride, total, band, rows, codes, grey, flat)
    disparity = np.empty((COUNT, columns), np.int16)
    sweep_columns(codes[0], codes[1], grey, span.downsample(factor).within(columns), SHARP.penalties, stride, disparity)
    disparity[flat] = UNKNOWN
    match_count = int(np.count_nonzero(disparity != UNKNOWN))
    speckle_count = remove_speckles(disparity, LARGEST_SPECK)
    return Bands(rows, disparity, factor, match_count - speckle_count, speckle_count / max(1, match_count))


@njit(**KERNEL)
def _encode_bands(left, right, factor, offsets, stride, total, band, rows, codes, grey, flat):
    """Write the bands' middle rows, their codes in both views, and the left view's grey values and flat pixels."""
    for i in range(rows.size):
        rows[i] = (2 * i + 1) * left.shape[0] // (2 * rows.size)
        _encode_band(right, rows[i], factor, offsets, flat.shape[1], total, band, codes[1, i : i + 1])
        _encode_band(left, rows[i], factor, offsets, flat.shape[1], total, band, codes[0, i : i + 1])
        for x in range(grey.shape[1]):
            grey[i, x] = band[RADIUS, RADIUS + x * stride]
        _find_flat_columns(band, flat[i])


@inner()
def _encode_band(view, row, factor, offsets, columns, total, band, codes):
    for j in range(TALL):
        _average_rows(view, row + (j - RADIUS) * HIGH_PX, factor, columns, total, band[j])
    code_rows(band, offsets, 0, 0, 1, codes)


@inner()
def _average_rows(view, middle, factor, columns, total, means):
    """Average HIGH_PX x factor pixels near row `middle` into each value; the picture's edge is repeated outwards."""
    h, w = view.shape
    scale = np.float32(1 / (HIGH_PX * factor))
    for x in range(total.size):
        total[x] = 0
    for y in range(middle - HIGH_PX // 2, middle - HIGH_PX // 2 + HIGH_PX):
        line = view[min(max(y, 0), h - 1)]
        for x in range(w):
            total[x] += line[x]
    for x in range(w, total.size):
        total[x] = total[w - 1]
    # In place: a sum is written over a pixel that no later sum reads.
    if factor > 1:
        for x in range(columns):
            whole = np.int32(0)
            for i in range(x * factor, (x + 1) * factor):
                whole += total[i]
            total[x] = whole
    for x in range(columns):
        means[RADIUS + x] = np.uint8(total[x] * scale + np.float32(0.5))
    for x in range(RADIUS):
        means[x] = means[RADIUS]
    for x in range(RADIUS + columns, means.size):
        means[x] = means[RADIUS + columns - 1]


@inner()
def _find_flat_columns(band, flat):
    for x in range(flat.size):
        flat[x] = True
    for j in range(TALL):
        line = band[j]
        for x in range(flat.size):
            level = True
            for k in range(1, 2 * FLAT_REACH + 1):
                level &= line[x] == line[x + k]
            flat[x] &= level


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
