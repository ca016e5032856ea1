"""Semi-global matching of a picture in strips, along four paths, one byte a pixel and disparity."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, UInt8
from numba import uint8, uint64

from tangible_core.compiled import KERNEL, in_turns, inner, njit

from ..dense.span import UNKNOWN, Span
from ..simd.lane_reductions import first_equal, first_lane, lowest
from ..simd.lanes import Lanes, load, minimum, saturating_add, shift_down, splat, store, width
from .costs import Penalties
from .paths import add_horizontal_paths, jump_penalties, jump_penalties_along, row_limits, step_vertical_path

WORST = np.uint8(255)  # sum of a disparity that is never accepted


def scratch(rows: int, w: int, n: int, planes: int) -> tuple[np.ndarray, ...]:
    """Allocate scratch memory for strips of at most `rows` rows of w columns, n lanes, and codes of `planes` planes."""
    return (
        np.empty((rows + rows % 2, w * n), np.uint8),
        np.empty((2, w * n), np.uint8),
        np.empty(w, np.uint8),
        np.empty((2, w * n), np.uint8),
        np.empty((3, w + 1), np.uint8),
        np.empty((planes, w + n - 1), np.uint8),
        np.empty(w, np.int32),
        np.empty(w + n, np.uint8),
        np.empty((2, w), np.uint8),
        np.empty(w, np.uint8),
    )


@inner()
def begin_path(paths, path_lowest):
    """Start a path with cost 0."""
    for path in paths:
        for i in range(path.size):
            path[i] = 0
    for i in range(path_lowest.size):
        path_lowest[i] = 0


@inner()
def _decide(lanes, total, path, finals, best, beside, sums, right_sums):
    """Add the last path; find the best lane, its sum and the two next to it per left pixel, the best sum per right."""
    n = width(lanes)
    w = best.size
    wall = splat(lanes, uint8(255))
    running_lowest = wall  # lowest sums so far of the n right pixels that later left pixels can match
    for x in range(w):
        # Neighbouring sums are read from `finals` at once, while they are in the cache.
        sum_here = saturating_add(load(lanes, total, x * n), load(lanes, path, x * n))
        store(finals, 0, sum_here)
        running_lowest = minimum(running_lowest, sum_here)
        right_sums[x] = first_lane(running_lowest)
        running_lowest = shift_down(running_lowest, wall)
        sums[x] = lowest(sum_here)
        k = best[x] = first_equal(sum_here, sums[x])  # never negative: uint64 spares numba a test
        beside[0, x], beside[1, x] = finals[uint64(max(k - 1, 0))], finals[uint64(min(k + 1, n - 1))]
    for i in range(n - 1):
        right_sums[w + i] = first_lane(running_lowest)
        running_lowest = shift_down(running_lowest, wall)


@inner()
def equiangular(before, at, after):
    """Return the tip of the symmetric V through three equally spaced costs, within +-0.5; 0 if they are equal."""
    # Costs that count differing bits grow linearly round their minimum: the parabola would pull towards whole numbers.
    # Source: Shimizu & Okutomi, Precise sub-pixel estimation on area-based matching, ICCV 2001.
    rise = max(before, after) - at
    return (before - after) / (rise + rise) if rise != 0 else rise


@inner()
def _accept(span, best, beside, sums, right_sums, right_best, most, check_tolerance, disparity):
    """Accept disparities whose right pixel no left pixel fits better by more than a factor; right_best: scratch."""
    # Without branches, as acceptance is unpredictable; scattered values are gathered first, so that the rest is vector
    # code.
    for i in range(most.size):
        right_sums[i] &= most[i]  # columns beyond the picture confirm nothing
    for x in range(best.size):
        right_best[x] = right_sums[uint64(x + best[x])]
    befores, afters = beside
    last = np.int32(span.high - span.low)
    high = np.int32(span.high)
    for x in range(best.size):
        k = np.int32(best[x])
        at, before, after = np.float32(sums[x]), np.float32(befores[x]), np.float32(afters[x])
        inner = (k > 0) & (k < last)
        # Neighbouring disparities that fit as well make a pixel ambiguous.
        flat = inner & (befores[x] == sums[x]) & (afters[x] == sums[x])
        fits = (sums[x] < WORST) & (at <= check_tolerance * np.float32(right_best[x]))
        offset = equiangular(before, at, after) if inner else np.float32(0)
        sixteenths = np.int16(np.floor(np.float32(16) * (np.float32(high - k) - offset) + np.float32(0.5)))
        disparity[x] = sixteenths if fits & (not flat) else UNKNOWN


@inner()
def shift_codes(row, w, top, codes):
    """Shift the right view's codes by `top` for the lanes; the picture's edge is repeated outwards."""
    end = codes.shape[1]
    first = min(max(top, 0), end)
    last = min(max(w + top, first), end)
    for plane in range(row.shape[0]):
        visible_codes = row[plane, first - top : last - top]
        for i in range(first):
            codes[plane, i] = row[plane, 0]
        inside = codes[plane, first:last]
        for i in range(inside.size):
            inside[i] = visible_codes[i]
        for i in range(last, end):
            codes[plane, i] = row[plane, w - 1]


@njit(**KERNEL)
def sweep_strip(
    lanes, left, right, grey, rows, warm, span, limits, penalties, check_tolerance, scratch, disparity, sums
):
    """Write disparities in sixteenths of a pixel (UNKNOWN if rejected) and winners' costs of rows[0]..rows[1]-1."""
    h, w = grey.shape
    y0, y1 = rows
    total, paths, path_lowest, costs, p2, codes, best, right_sums, beside, right_best = scratch
    p1, p2_across = penalties.p1, p2[2]
    # Each path is relative to its own minimum (Hirschmueller, IEEE PAMI 30(2), 2008, eq. 13), so that the winner's sum
    # of four paths is small and saturating bytes are enough: only losers reach 255. Paths start `warm` rows early,
    # which makes strips independent: any number of threads, bounded memory, and a volume that fits the caches. Lane k
    # stands for the disparity top - k, so that the right view's codes are contiguous: codes[i] is its column i - top.
    begin_path(paths, path_lowest)
    for y in range(max(0, y0 - warm), y1):
        row = (y - y0) & 1
        shift_codes(right[y], w, span.high, codes)
        jump_penalties(penalties, grey[y], grey[max(y - 1, 0)], p2_across)
        step_vertical_path(
            lanes, left[y], codes, limits, p1, p2_across, paths[1 - row], paths[row], path_lowest, costs[row]
        )
        if y >= y0:
            jump_penalties_along(penalties, grey[y], p2[row])
        if y >= y0 and (row == 1 or y + 1 == y1):  # an odd last row is paired with a dummy row
            i = y - row - y0
            upper = costs[0], p2[0], paths[0], total[i]
            lower = costs[1], p2[1], paths[1], total[i + 1]
            add_horizontal_paths(lanes, p1, upper, lower)
    begin_path(paths, path_lowest)
    path, finals = paths[0], costs[1]
    last = min(h, y1 + warm)
    for i in range(last - y0):
        y = last - 1 - i
        shift_codes(right[y], w, span.high, codes)
        jump_penalties(penalties, grey[y], grey[min(y + 1, h - 1)], p2_across)
        step_vertical_path(lanes, left[y], codes, limits, p1, p2_across, path, path, path_lowest, costs[0])
        if y < y1:
            _decide(lanes, total[y - y0], path, finals, best, beside, sums[y], right_sums)
            _accept(span, best, beside, sums[y], right_sums, right_best, limits.most, check_tolerance, disparity[y])


ROWS = 128
# Rows before a strip at which its paths start: rows farther away hardly affect it.
WARM_ROWS = 16
VOLUME_BYTES = 256 << 20  # largest memory for the cost volumes of all threads together, bytes
# Fewest strips in memory at once; more run in parallel only if they are small.
AT_ONCE = 4
MAX_LANES = 512  # largest number of SIMD lanes, so of disparities at full size


class StripMatches(NamedTuple):
    """Disparity in sixteenths of a pixel, UNKNOWN if none passed the left-right check, and the winner's cost."""

    disparity: Int16[np.ndarray, "h w"]
    sums: UInt8[np.ndarray, "h w"]


def unknown_matches(shape: tuple[int, int]) -> StripMatches:
    """Allocate a map of UNKNOWN disparities."""
    return StripMatches(np.full(shape, UNKNOWN, np.int16), np.full(shape, 255, np.uint8))


def strips(shape: tuple[int, int], span: Span) -> list[tuple[int, int]]:
    """Return first and last + 1 row of each strip: ROWS high, or lower if AT_ONCE volumes would exceed VOLUME_BYTES."""
    h, w = shape
    # Independent of the number of threads, as seams are visible in a map.
    rows = max(8, min(ROWS, VOLUME_BYTES // (AT_ONCE * w * span.lanes)))
    return [(y, min(y + rows, h)) for y in range(0, h, rows)]


def sweep(
    codes: tuple[UInt8[np.ndarray, "h planes whole"], UInt8[np.ndarray, "h planes whole"]],
    grey: UInt8[np.ndarray, "h w"],
    span: Span,
    penalties: Penalties,
    check_tolerance: float,
    only: Sequence[tuple[int, int]],
    out: StripMatches,
    warm: int = WARM_ROWS,
    most_level: int = 0,
) -> None:
    """Match the strips `only` into `out`, their paths begun `warm` rows early; independent of the number of threads."""
    w, n = grey.shape[1], span.lanes
    planes = codes[0].shape[1]
    lanes = Lanes(n, planes - (most_level > 0), most_level)
    limits = row_limits(n, w, span, penalties.neutral)
    highest = max((y1 - y0 for y0, y1 in only), default=0)

    def work(share: Iterable[tuple[int, int]]) -> None:
        room = scratch(highest, w, n, planes)
        for rows in share:
            sweep_strip(
                lanes, *codes, grey, rows, warm, span, limits, penalties, np.float32(check_tolerance), room, *out
            )

    highest_first = sorted(only, key=lambda rows: rows[0] - rows[1])  # so that all threads end at about the same time
    in_turns(highest_first, work, max(1, VOLUME_BYTES // max(1, highest * w * n)))
