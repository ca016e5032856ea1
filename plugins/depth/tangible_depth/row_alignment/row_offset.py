"""The vertical offset between the rows of a pair: half a pixel already costs a matcher a good part of its matches."""

import numpy as np
from jaxtyping import Float32, Int16, Int64

from tangible_core.compiled import KERNEL, in_blocks, inner, njit

from ..dense.span import UNKNOWN
from ..search.pairs import Pair
from ..windows.correlation import parabola

CELL_PX = 12  # width of a cell, in columns; the strongest edge of a cell has a vote
NEAR_PX = 1  # rows above and below a given row in which its edges are sought
MAX_POINTS = 250  # largest number of edges that vote, for speed
MIN_VOTES = 20
MIN_ROW_OFFSET_PX = 0.3
MIN_EDGE = 40  # smallest Sobel response across rows, in grey levels, of a pixel that determines its row
RADIUS, REACH = 3, 2  # radius of the correlation window, and rows tried up and down, in pixels
# Lowest correlation of a match, and smallest curvature of its peak, which a vote needs.
MIN_CORRELATION, MIN_BEND = 0.7, 0.02


def row_votes(
    pair: Pair, rows: Int64[np.ndarray, "n"], disparity: Int16[np.ndarray, "n columns"], factor: int = 1
) -> Float32[np.ndarray, "votes"]:
    """Return right row - left row, in pixels, of up to MAX_POINTS horizontal edges on or near `rows`; NaN: no match."""
    points = np.empty((len(rows) * (pair.width // CELL_PX), 3), np.int64)
    points = points[: _edge_points(pair.left, rows, disparity, factor, points)]
    points = np.ascontiguousarray(points[:: 1 + len(points) // MAX_POINTS])
    votes = np.full(len(points), np.nan, np.float32)

    def block(first: int, last: int) -> None:
        _vote(*pair, points, factor, first, last, np.empty(2 * REACH + 1, np.float32), votes)

    in_blocks(len(points), block)
    return votes


def row_offset(pair: Pair, rows: Int64[np.ndarray, "n"], disparity: Int16[np.ndarray, "n w"], factor: int = 1) -> float:
    """Return the median of the `row_votes`, in pixels; 0 if there are too few."""
    votes = row_votes(pair, rows, disparity, factor)
    offsets_px = votes[np.isfinite(votes)]
    return float(np.median(offsets_px)) if offsets_px.size >= MIN_VOTES else 0.0


@njit(**KERNEL)
def _edge_points(left, rows, disparity, factor, points):
    """Write row, column and disparity of the strongest horizontal edge in each cell; return their number."""
    h, w = left.shape
    count = 0
    for i in range(rows.size):
        for first in range(1, w - CELL_PX, CELL_PX):
            strongest = np.int64(MIN_EDGE)
            for y in range(max(rows[i] - NEAR_PX, 1), min(rows[i] + NEAR_PX + 1, h - 1)):
                up, down = left[y - 1], left[y + 1]
                for x in range(first, first + CELL_PX):
                    edge = np.int64(down[x - 1]) + 2 * down[x] + down[x + 1]
                    edge = abs(edge - np.int64(up[x - 1]) - 2 * up[x] - up[x + 1])
                    here = disparity[i, x // factor]
                    if edge > strongest and here != UNKNOWN:
                        strongest = edge
                        points[count, 0], points[count, 1] = y, x
                        points[count, 2] = (np.int64(here) * factor + 8) >> 4
            count += strongest > MIN_EDGE
    return count


@njit(**KERNEL)
def _vote(left, right, points, slack, first, last, scores, votes):
    """Write the sub-pixel row offset of the best correlation near each point; NaN for a poor match. scores: scratch."""
    h, w = left.shape
    reach = scores.size >> 1
    edge = RADIUS + reach
    for p in range(first, last):
        y, x, column = points[p, 0], points[p, 1], points[p, 1] - points[p, 2]
        if not (edge <= y < h - edge and RADIUS <= x < w - RADIUS):
            continue
        if not (RADIUS + slack <= column < w - RADIUS - slack):
            continue
        for dy in range(-reach, reach + 1):
            scores[dy + reach] = -1
            for dx in range(-slack, slack + 1):
                scores[dy + reach] = max(scores[dy + reach], _correlation(left, y, x, right, y + dy, column + dx))
        best = 0
        for i in range(1, scores.size):
            best = i if scores[i] > scores[best] else best
        if 0 < best < 2 * reach and scores[best] >= MIN_CORRELATION:
            before, at, after = scores[best - 1], scores[best], scores[best + 1]
            if 2 * at - before - after > MIN_BEND:
                votes[p] = best - reach + parabola(before, at, after)


@inner()
def _correlation(left, y, x, right, v, u):
    """Return the zero-mean normalised cross-correlation of two windows; -1 if either is nearly flat."""
    a_sum = b_sum = aa = bb = ab = np.int32(0)
    for i in range(-RADIUS, RADIUS + 1):
        for j in range(-RADIUS, RADIUS + 1):
            a, b = np.int32(left[y + i, x + j]), np.int32(right[v + i, u + j])
            a_sum += a
            b_sum += b
            aa += a * a
            bb += b * b
            ab += a * b
    n = (2 * RADIUS + 1) ** 2
    a_spread, b_spread = n * aa - a_sum * a_sum, n * bb - b_sum * b_sum
    if min(a_spread, b_spread) <= 4 * n * n:
        return np.float32(-1)
    return np.float32((n * ab - a_sum * b_sum) / np.sqrt(float(a_spread) * float(b_spread)))
