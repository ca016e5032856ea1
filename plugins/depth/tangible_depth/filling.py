"""Disparity where none was found, from what both views and the picture's edges say.

The four nearest known neighbours (left, right, above, below) are the candidates for a pixel. Each is judged by

- both views (binocular): had the pixel this disparity, it would be seen at column x - d of the right view. Where
  something at least as near is known to be seen there, the pixel is hidden and the candidate explains why it had no
  match; where something farther is seen, the candidate is contradicted; outside the picture it is explained as well;
- the picture (monocular): grey steps crossed on the way from the neighbour, as a surface seldom goes on behind an edge;
- the rule that what is hidden lies behind: farther candidates, and the farther one of the row first.

The weights come from a logistic regression over four Middlebury pairs, rounded; results are flat around them.
Source of the idea of filling from the farther side: Hirschmueller 2008, sec. 2.7.2.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int32, njit

from tangible_core.threads import in_blocks

from .span import UNKNOWN

FARTHER_OF_ROW, CONTRADICTED, EXPLAINED = 1.2, -2.0, 1.0
PER_ROOT_OF_GREY, PER_10_PX_NEARER = -0.2, -0.3
ALIKE = 24
"""Sixteenths of a pixel by which two disparities may differ and still be called the same surface."""
SHORT = 2
"""Columns of a gap that is closed without asking, where both ends are alike."""
LEFT, RIGHT, ABOVE, BELOW = range(4)
NEVER = np.int32(32767)


def fill(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """The map with every UNKNOWN pixel filled; known pixels keep their value, a map without any stays as it is.

    disparity is in sixteenths of a pixel.
    """
    filled = _fill_once(disparity, grey)
    if (filled == UNKNOWN).any() and (filled != UNKNOWN).any():  # some saw nothing along their row and column
        filled = _fill_once(filled, grey)
    return filled


def _fill_once(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    out = disparity.copy()
    in_blocks(disparity.shape[0], lambda a, b: _fill_rows(disparity, grey, a, b, out))
    return out


@njit(nogil=True, boundscheck=False, cache=True)
def _fill_rows(disparity, grey, y0, y1, out):
    w = disparity.shape[1]
    sides, paths = np.empty((4, w), np.int16), np.empty((4, w), np.int32)
    below, below_path = np.empty((y1 - y0, w), np.int16), np.empty((y1 - y0, w), np.int32)
    seen = np.empty(w, np.int16)
    _scan_up(disparity, grey, y0, y1, below, below_path)
    _start_above(disparity, grey, y0, sides[ABOVE], paths[ABOVE])
    for y in range(y0, y1):
        if y > 0:
            _carry(disparity[y - 1], grey[y - 1], grey[y], sides[ABOVE], paths[ABOVE])
        sides[BELOW], paths[BELOW] = below[y - y0], below_path[y - y0]
        _seen_from_the_right(disparity[y], seen)
        start = 0
        while start < w:
            if disparity[y, start] != UNKNOWN:
                start += 1
                continue
            stop = start + 1
            while stop < w and disparity[y, stop] == UNKNOWN:
                stop += 1
            if stop - start <= SHORT and start > 0 and stop < w and _alike(disparity[y, start - 1], disparity[y, stop]):
                for x in range(start, stop):  # one of the many gaps between whole disparities
                    out[y, x] = min(disparity[y, start - 1], disparity[y, stop])
            else:
                _scan_gap(disparity[y], grey[y], start, stop, sides, paths)
                for x in range(start, stop):
                    out[y, x] = _choose(sides, paths, x, seen)
            start = stop


@njit(inline="always")
def _alike(a, b):
    return abs(int32(a) - int32(b)) <= ALIKE


@njit(nogil=True, boundscheck=False)
def _carry(row, grey, next_grey, carried, path):
    """Step from one row to the next: what is known there starts afresh, the rest goes on with its path."""
    for x in range(row.size):
        known = row[x] != UNKNOWN
        carried[x] = row[x] if known else carried[x]
        path[x] = (int32(0) if known else path[x]) + abs(int32(grey[x]) - int32(next_grey[x]))


@njit(nogil=True, boundscheck=False)
def _scan_up(disparity, grey, y0, y1, below, path):
    """The nearest known value below each pixel of rows y0..y1-1, and the grey steps on the way."""
    h, w = disparity.shape
    carried, steps = np.full(w, UNKNOWN, np.int16), np.zeros(w, np.int32)
    last = min(_reach(disparity, y1, 1), h - 1)
    for i in range(last - y0 + 1):
        y = last - i
        if y + 1 < h:
            _carry(disparity[y + 1], grey[y + 1], grey[y], carried, steps)
        if y < y1:
            below[y - y0], path[y - y0] = carried, steps


@njit(nogil=True, boundscheck=False)
def _start_above(disparity, grey, y0, carried, path):
    """The state of a downward scan that has reached row y0 - 1."""
    carried[:] = UNKNOWN
    path[:] = 0
    for y in range(max(_reach(disparity, y0 - 1, -1), 0), y0 - 1):
        _carry(disparity[y], grey[y], grey[y + 1], carried, path)


@njit(nogil=True, boundscheck=False)
def _reach(disparity, y, step):
    """The row at which, from row y on, every column has shown a known value; past the picture if some show none."""
    missing = np.ones(disparity.shape[1], np.bool_)
    while 0 <= y < disparity.shape[0]:
        missing &= disparity[y] == UNKNOWN
        if not missing.any():
            break
        y += step
    return y


@njit(nogil=True, boundscheck=False)
def _scan_gap(row, grey, start, stop, sides, paths):
    """What the known pixels at both ends of a gap offer to each pixel in it."""
    w = row.size
    left = row[start - 1] if start > 0 else UNKNOWN
    path = int32(0)
    for x in range(start, stop):
        path += abs(int32(grey[x]) - int32(grey[max(x - 1, 0)]))
        sides[LEFT, x], paths[LEFT, x] = left, path
    right = row[stop] if stop < w else UNKNOWN
    path = int32(0)
    for i in range(stop - start):
        x = stop - 1 - i
        path += abs(int32(grey[x]) - int32(grey[min(x + 1, w - 1)]))
        sides[RIGHT, x], paths[RIGHT, x] = right, path


@njit(nogil=True, boundscheck=False)
def _seen_from_the_right(row, seen):
    """The nearest disparity known to be seen at each column of the right view, UNKNOWN where none is."""
    seen[:] = UNKNOWN
    for x in range(row.size):
        if row[x] != UNKNOWN:
            column = x - ((int32(row[x]) + 8) >> 4)
            if 0 <= column < row.size:
                seen[column] = max(seen[column], row[x])


@njit(nogil=True, boundscheck=False)
def _choose(sides, paths, x, seen):
    """The candidate of the highest score; UNKNOWN if there is none."""
    left, right, above, below = sides[LEFT, x], sides[RIGHT, x], sides[ABOVE, x], sides[BELOW, x]
    row_farthest = min(_or_never(left), _or_never(right))
    farthest = min(row_farthest, _or_never(above), _or_never(below))
    if farthest == NEVER:
        return UNKNOWN
    if max(left, right, above, below) - farthest <= ALIKE:
        return np.int16(farthest if row_farthest == NEVER else row_farthest)
    best, best_score = UNKNOWN, np.float32(-1e9)
    for side in range(4):
        value = int32(sides[side, x])
        score = _score(value, paths[side, x], farthest, row_farthest, x, seen)
        best = np.int16(value) if score > best_score else best
        best_score = max(score, best_score)
    return best


@njit(inline="always")
def _or_never(value):
    return NEVER if value == UNKNOWN else int32(value)


@njit(inline="always")
def _score(value, path, farthest, row_farthest, x, seen):
    """Without branches: what a pixel's candidates are like, no processor can guess."""
    column = x - ((value + 8) >> 4)
    inside = (column >= 0) & (column < seen.size)
    there = int32(seen[min(max(column, 0), seen.size - 1)])
    explained = (not inside) | (there > value + ALIKE)
    contradicted = inside & (there != UNKNOWN) & (there < value - ALIKE)
    score = np.float32(PER_10_PX_NEARER / 160) * np.float32(value - farthest)
    score += np.float32(PER_ROOT_OF_GREY) * np.sqrt(np.float32(path))
    score += np.float32(EXPLAINED) * np.float32(explained) + np.float32(CONTRADICTED) * np.float32(contradicted)
    score += np.float32(FARTHER_OF_ROW) * np.float32(value <= row_farthest + 8)
    return np.float32(-1e9) if value == UNKNOWN else score
