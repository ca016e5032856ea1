"""Scores of the candidates for an unknown disparity, by both views and by the edges of the picture.

The candidates of a pixel are the nearest known values to the left, right, above and below it (with `effort: best`, on
the diagonals too) and, at the left border, the one at the end of a geodesic path. A score is a sum of three terms:

- both views (binocular): a pixel of disparity d is seen at column x - d of the right view. If a nearer surface is seen
  there, the pixel is occluded, which explains the missing match, as a column beyond the picture does; if a farther
  surface is seen there, the candidate is contradicted; if no pixel was matched with that column, it is less likely;
- the picture (monocular): the grey steps crossed on the path from the neighbour, as few surfaces continue across edges;
- the order in depth: occluded pixels lie behind, so farther candidates score higher, and so does the farther of a row.

The weights come from a logistic regression (which candidate of a pixel is within 2 px of the truth) over four
Middlebury pairs and twelve scenes, rounded; the error hardly depends on them near these values.
Source of filling from the farther side: Hirschmueller 2008, sec. 2.7.2.
"""

# ruff: noqa: ANN001, ANN201 -- numba infers the types of kernels; their docstrings give them

import numpy as np
from numba import int32, uint32

from tangible_core.compiled.compiling import inner

from ..span import UNKNOWN

FARTHER_OF_ROW, CONTRADICTED, UNMATCHED_THERE, BEYOND_PICTURE = 0.7, -3.4, -1.4, 0.75
"""Terms of the score: the farther candidate of the row; a farther surface, no match, no picture in the right view."""
PER_ROOT_OF_GREY, PER_10_PX_NEARER = -0.18, -0.3
"""Terms per square root of the grey levels crossed, and per 10 px that a candidate is nearer than the farthest."""
GEODESIC_SCORE = -1.0
"""Term of a candidate at the end of a geodesic path, which is less certain than a straight neighbour."""
SAME_SURFACE = 24
"""Largest difference, in sixteenths of a pixel, of two disparities of one surface."""
NEAREST = np.int32(32767)
"""Disparity nearer than every real one, in sixteenths of a pixel."""


@inner()
def project_to_right(row, columns, seen):
    """Find the nearest known disparity seen at each column x of the right view, UNKNOWN without one: seen[x + 1].

    Both ends of `seen` stand for all columns beyond the picture; they hold NEAREST. columns: scratch.
    """
    for x in range(seen.size):
        seen[x] = UNKNOWN
    seen[0] = seen[-1] = NEAREST
    for x in range(row.size):
        columns[x] = right_column(int32(x), int32(row[x]), int32(seen.size - 1))
    for x in range(row.size):
        column = uint32(columns[x])  # never negative, which spares numba a test
        seen[column] = max(seen[column], row[x])


@inner()
def right_column(x, value, last):
    """Return the index in `seen` of a pixel with this disparity."""
    return min(max(x + int32(1) - ((value + int32(8)) >> int32(4)), int32(0)), last)


@inner()
def known_or_nearest(value):
    """Return a disparity, NEAREST for UNKNOWN: for minima."""
    return NEAREST if value == UNKNOWN else int32(value)


@inner()
def score_candidate(value, path, farthest, row_farthest, x, seen):
    """Score a candidate, the higher the better; UNKNOWN scores lowest. Without branches: they are unpredictable."""
    there = int32(seen[right_column(x, value, seen.size - 1)])
    rated = np.float32(PER_10_PX_NEARER / 160) * np.float32(value - farthest)
    rated += np.float32(PER_ROOT_OF_GREY) * np.sqrt(np.float32(path))
    rated += np.float32(FARTHER_OF_ROW) * np.float32(value <= row_farthest + 8)
    behind = np.float32(CONTRADICTED) if there < value - SAME_SURFACE else np.float32(0)
    behind = np.float32(UNMATCHED_THERE) if there == UNKNOWN else behind
    rated += np.float32(BEYOND_PICTURE) if there == NEAREST else behind
    return np.float32(-1e9) if value == UNKNOWN else rated
