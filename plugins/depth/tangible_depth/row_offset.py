"""By how much the rows of a pair miss each other, and putting that right.

Half a pixel of vertical offset already costs a matcher of rows a good part of its matches.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int16, Int64, UInt8
from numba import njit

from tangible_core.threads import in_blocks

from .pairs import Pair
from .span import UNKNOWN
from .subpixel import parabola

CELL_PX, MOST_POINTS, LEAST_VOTES = 12, 400, 20
LEAST_EDGE = 40
"""Sobel response over rows from which a pixel says something about its row."""
RADIUS = 3
LEAST_CORRELATION, LEAST_BEND = 0.7, 0.02


def row_offset(
    pair: Pair, rough: Int16[np.ndarray, "h w"], rows: Sequence[tuple[int, int]], reach: int = 2, slack: int = 1
) -> float:
    """Median of (row in the right view - row in the left view) over up to MOST_POINTS horizontal edges; 0 if too few.

    Parameters: rough, disparities in sixteenths of a pixel, UNKNOWN where there is none; rows, the ranges of rows to
    look at; reach, offsets up to reach - 1 pixels are measured; slack, by how many pixels `rough` may be wrong.
    """
    points = np.concatenate([np.empty((0, 3), np.int64), *(_edge_points(pair.left, rough, *each) for each in rows)])
    points = np.ascontiguousarray(points[:: 1 + len(points) // MOST_POINTS])
    offsets = np.full(len(points), np.nan, np.float32)
    in_blocks(len(points), lambda a, b: _offsets(*pair, points, reach, slack, a, b, offsets))
    votes = offsets[np.isfinite(offsets)]
    return float(np.median(votes)) if votes.size >= LEAST_VOTES else 0.0


def realigned(pair: Pair, offset: float) -> Pair:
    """The pair with its right view moved up by `offset` rows, so that rows correspond; cubic between rows."""
    import cv2

    whole = round(offset) if abs(offset - round(offset)) < 0.15 else offset
    move = np.array([[1, 0, 0], [0, 1, -whole]], np.float32)
    moved = cv2.warpAffine(
        pair.right, move, pair.right.shape[::-1], flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
    )
    return Pair(pair.left, moved)  # pyright: ignore[reportArgumentType]


def _edge_points(
    left: UInt8[np.ndarray, "h w"], rough: Int16[np.ndarray, "h w"], y0: int, y1: int
) -> Int64[np.ndarray, "n 3"]:
    """Row, column and disparity of the strongest horizontal edge with a disparity in each cell of rows y0..y1-1."""
    import cv2

    known = rough[y0:y1]
    edges = cv2.convertScaleAbs(cv2.Sobel(left[y0:y1], cv2.CV_16S, 0, 1)) * (known != UNKNOWN)
    down, across = edges.shape[0] // CELL_PX, edges.shape[1] // CELL_PX
    cells = edges[: down * CELL_PX, : across * CELL_PX].reshape(down, CELL_PX, across, CELL_PX)
    cells = cells.transpose(0, 2, 1, 3).reshape(down * across, CELL_PX * CELL_PX)
    if cells.size == 0:
        return np.empty((0, 3), np.int64)
    at = cells.argmax(1)
    rows, columns = np.divmod(np.arange(down * across), across)
    y, x = rows * CELL_PX + at // CELL_PX, columns * CELL_PX + at % CELL_PX
    strong = cells.max(1) > LEAST_EDGE
    return np.stack([y + y0, x, (known[y, x].astype(np.int64) + 8) >> 4], 1)[strong]


@njit(nogil=True, boundscheck=False, cache=True, error_model="numpy")
def _offsets(left, right, points, reach, slack, first, last, offsets):
    """Sub-pixel row offset of the best correlation near each point; NaN where the match is poor."""
    h, w = left.shape
    edge = RADIUS + reach
    scores = np.empty(2 * reach + 1, np.float32)
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
        best = np.argmax(scores)
        if 0 < best < 2 * reach and scores[best] >= LEAST_CORRELATION:
            before, at, after = scores[best - 1], scores[best], scores[best + 1]
            if 2 * at - before - after > LEAST_BEND:
                offsets[p] = best - reach + parabola(before, at, after)


@njit(nogil=True, boundscheck=False, error_model="numpy")
def _correlation(left, y, x, right, v, u):
    """Zero-mean normalised cross-correlation of two windows; -1 if either is nearly flat."""
    a_sum = b_sum = aa = bb = ab = np.int64(0)
    for i in range(-RADIUS, RADIUS + 1):
        for j in range(-RADIUS, RADIUS + 1):
            a, b = np.int64(left[y + i, x + j]), np.int64(right[v + i, u + j])
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
