"""Which neighbour an unknown disparity is taken from, by what both views and the picture's edges say.

The nearest known neighbours (left, right, above, below, and the diagonals where it may take longer) are the candidates
for a pixel; at the left border also what a detour leads to. Each is judged by

- both views (binocular): had the pixel this disparity, it would be seen at column x - d of the right view. Where
  something nearer is known to be seen there, the pixel is hidden and that explains why it had no match, as it does
  beyond the picture; where something farther is seen, the candidate is contradicted; where something is seen that
  nothing was matched with, it is less likely;
- the picture (monocular): grey steps crossed on the way from the neighbour, as a surface seldom goes on behind an edge;
- the rule that what is hidden lies behind: farther candidates, and the farther one of the row first.

The weights come from a logistic regression (which candidate of a pixel is within 2 px of the truth) over four
Middlebury pairs and twelve scenes, rounded; results are flat around them.
Source of the idea of filling from the farther side: Hirschmueller 2008, sec. 2.7.2.
"""

# ruff: noqa: ANN001, ANN201 -- numba finds the types of what it compiles; the docstrings say them

import numpy as np
from numba import int32, uint32

from tangible_core.compiled.compiling import inner

from ..span import UNKNOWN

FARTHER_OF_ROW, CONTRADICTED, UNMATCHED_THERE, BEYOND = 0.7, -3.4, -1.4, 0.75
PER_ROOT_OF_GREY, PER_10_PX_NEARER = -0.18, -0.3
DETOUR = -1.0
ALIKE = 24
"""Sixteenths of a pixel by which two disparities may differ and still be called the same surface."""
NEVER = np.int32(32767)


@inner()
def seen_from_the_right(row, columns, seen):
    """The nearest disparity known to be seen at each column x of the right view: at x + 1, UNKNOWN where none is.

    Both ends stand for all columns beyond the picture, where something nearer than anything is seen. columns: scratch.
    """
    for x in range(seen.size):
        seen[x] = UNKNOWN
    seen[0] = seen[-1] = NEVER
    for x in range(row.size):
        columns[x] = column_of(int32(x), int32(row[x]), int32(seen.size - 1))
    for x in range(row.size):
        column = uint32(columns[x])  # never negative, and numba need not ask
        seen[column] = max(seen[column], row[x])


@inner()
def column_of(x, value, last):
    """Where in `seen` a pixel of this disparity is."""
    return min(max(x + int32(1) - ((value + int32(8)) >> int32(4)), int32(0)), last)


@inner()
def or_never(value):
    """A disparity, or NEVER where there is none: for minima."""
    return NEVER if value == UNKNOWN else int32(value)


@inner()
def score(value, path, farthest, row_farthest, x, seen):
    """Without branches: what a pixel's candidates are like, no processor can guess. UNKNOWN scores less than any."""
    there = int32(seen[column_of(x, value, seen.size - 1)])
    rated = np.float32(PER_10_PX_NEARER / 160) * np.float32(value - farthest)
    rated += np.float32(PER_ROOT_OF_GREY) * np.sqrt(np.float32(path))
    rated += np.float32(FARTHER_OF_ROW) * np.float32(value <= row_farthest + 8)
    behind = np.float32(CONTRADICTED) if there < value - ALIKE else np.float32(0)
    behind = np.float32(UNMATCHED_THERE) if there == UNKNOWN else behind
    rated += np.float32(BEYOND) if there == NEVER else behind
    return np.float32(-1e9) if value == UNKNOWN else rated
