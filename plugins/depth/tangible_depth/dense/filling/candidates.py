"""Scores of the candidates for an unknown disparity, by both views and by the edges of the picture."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, Int32, Int64, UInt8
from numba import int32, uint32

from tangible_core.compiled import KERNEL, inner, njit

from ..span import UNKNOWN

PER_PIXEL = 1  # length of a step to a neighbour of equal grey, in grey levels
# Directions of the sweeps: from the last pixel to the first, as known pixels lie to the right, and back.
SWEEPS = (-1, 1)
# Length where no path leads to a known pixel, in grey levels: longer than any path.
NO_WAY = np.int32(1 << 28)


class GeodesicCandidates(NamedTuple):
    """Disparity at the end of the shortest path before the first known pixel of a row, and the path's grey levels."""

    # The first known column of each row; 0 without one, as the width of the border is unknown there.
    first: Int64[np.ndarray, " h"]
    values: Int16[np.ndarray, "h columns"]
    lengths: Int32[np.ndarray, "h columns"]


def geodesic_candidates(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> GeodesicCandidates:
    """Find the candidates of a map in sixteenths of a pixel; UNKNOWN where no path leads to a known pixel."""
    valid_mask = disparity != UNKNOWN
    first = valid_mask.argmax(axis=1)
    part = slice(None), slice(int(first.max()) + 1)
    values = np.pad(disparity[part], 1, constant_values=UNKNOWN)
    lengths = np.pad(np.where(valid_mask[part], np.int32(0), NO_WAY), 1, constant_values=NO_WAY)
    greys = np.pad(grey[part].astype(np.int32), 1)
    for step in SWEEPS:
        _sweep(greys, first, step, values, lengths)
    return GeodesicCandidates(first, values[1:-1, 1:-1], lengths[1:-1, 1:-1])


@njit(**KERNEL)
def _sweep(grey, first, step, values, lengths):
    """Shorten the paths in one sweep; arrays have a margin of one pixel."""
    # The right view does not show the left border, so that a wide strip there has no matches, and no known pixel of its
    # surface may lie straight ahead: the path of least grey change may turn. Two sweeps, forth and back, find it
    # (Toivanen, Pattern Recognition Letters 17, 1996); no path crosses the margin or a later gap.
    h = first.size
    for i in range(h):
        y = i + 1 if step > 0 else h - i
        v = y - step
        for j in range(first[y - 1]):
            x = j + 1 if step > 0 else first[y - 1] - j
            here = grey[y, x]
            length, value = lengths[y, x], values[y, x]
            ahead = lengths[y, x - step] + abs(grey[y, x - step] - here) + int32(PER_PIXEL)
            value = values[y, x - step] if ahead < length else value
            length = min(length, ahead)
            for u in range(x - 1, x + 2):
                ahead = lengths[v, u] + abs(grey[v, u] - here) + int32(PER_PIXEL)
                value = values[v, u] if ahead < length else value
                length = min(length, ahead)
            lengths[y, x], values[y, x] = length, value


# Terms of the score: the farther candidate of the row; a farther surface, no match, no picture in the right view.
FARTHER_OF_ROW, CONTRADICTED, UNMATCHED_THERE, BEYOND_PICTURE = 0.7, -3.4, -1.4, 0.75
# Terms per square root of the grey levels crossed, and per 10 px that a candidate is nearer than the farthest.
PER_ROOT_OF_GREY, PER_10_PX_NEARER = -0.18, -0.3
# Term of a candidate at the end of a geodesic path, which is less certain than a straight neighbour.
GEODESIC_SCORE = -1.0
SAME_SURFACE = 24  # largest difference, in sixteenths of a pixel, of two disparities of one surface
NEAREST = np.int32(32767)  # disparity nearer than every real one, in sixteenths of a pixel


@inner()
def project_to_right(row, columns, nearest):
    """Write the nearest disparity at each right column x to seen[x + 1], UNKNOWN without one; columns: scratch."""
    for x in range(nearest.size):
        nearest[x] = UNKNOWN
    # Both ends stand for all columns beyond the picture.
    nearest[0] = nearest[-1] = NEAREST
    for x in range(row.size):
        columns[x] = right_column(int32(x), int32(row[x]), int32(nearest.size - 1))
    for x in range(row.size):
        column = uint32(columns[x])  # never negative, which spares numba a test
        nearest[column] = max(nearest[column], row[x])


@inner()
def right_column(x, value, last):
    """Return the index in `seen` of a pixel with this disparity."""
    return min(max(x + int32(1) - ((value + int32(8)) >> int32(4)), int32(0)), last)


@inner()
def known_or_nearest(value):
    """Return a disparity, NEAREST for UNKNOWN: for minima."""
    return NEAREST if value == UNKNOWN else int32(value)


@inner()
def score_candidate(value, path, farthest, row_farthest, x, nearest):
    """Score a candidate, the higher the better; UNKNOWN scores lowest. Without branches: they are unpredictable."""
    # Seen at column x - d of the right view, a nearer surface means that the pixel is occluded, which explains the
    # missing match, as a column beyond the picture does; a farther surface contradicts the candidate; an unmatched
    # column makes it less likely. Few surfaces continue across edges, so grey steps count against it, and occluded
    # pixels lie behind, so farther candidates score higher (Hirschmueller 2008, sec. 2.7.2). The weights come from a
    # logistic regression (which candidate is within 2 px) over four pairs and twelve scenes; near these values the
    # error hardly depends on them.
    there = int32(nearest[right_column(x, value, nearest.size - 1)])
    score = np.float32(PER_10_PX_NEARER / 160) * np.float32(value - farthest)
    score += np.float32(PER_ROOT_OF_GREY) * np.sqrt(np.float32(path))
    score += np.float32(FARTHER_OF_ROW) * np.float32(value <= row_farthest + 8)
    behind = np.float32(CONTRADICTED) if there < value - SAME_SURFACE else np.float32(0)
    behind = np.float32(UNMATCHED_THERE) if there == UNKNOWN else behind
    score += np.float32(BEYOND_PICTURE) if there == NEAREST else behind
    return np.float32(-1e9) if value == UNKNOWN else score
