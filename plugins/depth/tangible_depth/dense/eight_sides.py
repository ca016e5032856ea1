"""Disparity where none was found, from the nearest known pixels on eight sides: what `effort: best` fills with.

As `filling`, with the four diagonals besides, and one more thing asked of the right view: a candidate that would be
seen where the right view shows something that nothing was matched with is less likely. The weights come from a
regression (which candidate of a pixel is within 2 px of the truth) over two photographs and twelve scenes, rounded.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int32, njit, uint16

from tangible_core.compiled.compiling import KERNEL, inner

from .candidates import NEVER, alike, column_of, or_never, seen_from_the_right
from .filling import fill
from .span import UNKNOWN

FARTHER_OF_ROW, CONTRADICTED, UNMATCHED_THERE, BEYOND, DIAGONAL = 0.4, -4.0, -1.4, 0.25, -1.0
PER_ROOT_OF_GREY, PER_10_PX_NEARER = -0.16, -0.11
HALF = 4
"""Sides seen from one end of the picture, mirrored from the other: in the row, straight on, and two diagonals."""
LONGEST_PATH = 65535


def fill_from_eight_sides(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> np.ndarray:
    """The map with every UNKNOWN pixel filled; known pixels keep their value, a map without any stays as it is.

    disparity is in sixteenths of a pixel.
    """
    missing = np.count_nonzero(disparity == UNKNOWN)
    if missing in (0, disparity.size):
        return disparity.copy()
    w = disparity.shape[1]
    values, paths = np.empty((2, missing, HALF), np.int16), np.empty((2, missing, HALF), np.uint16)
    for end, step in enumerate((1, -1)):
        carried, steps = np.empty((2, HALF, w), np.int16), np.empty((2, HALF, w), np.int32)
        _look(disparity, grey, step, carried, steps, values[end], paths[end])
    out = disparity.copy()
    _choose_all(disparity, values, paths, np.empty(w + 2, np.int16), np.empty(w, np.int32), out)
    return fill(out, grey)  # some saw nothing on any side


@njit(**KERNEL)
def _look(disparity, grey, step, carried, steps, values, paths):
    """What each UNKNOWN pixel sees on four sides, those passed on the way from the first (step 1) or last pixel."""
    h, w = disparity.shape
    at = 0 if step > 0 else values.shape[0] - 1
    for i in range(h):
        y = i if step > 0 else h - 1 - i
        before, now = carried[(i + 1) & 1], carried[i & 1]
        steps_before, steps_now = steps[(i + 1) & 1], steps[i & 1]
        for j in range(w):
            x = j if step > 0 else w - 1 - j
            for side in range(HALF):
                v = y if side == 0 else y - step
                u = x - step if side == 0 else x + side - 2
                value, path = UNKNOWN, int32(0)
                if 0 <= v < h and 0 <= u < w:
                    value = disparity[v, u]
                    if value == UNKNOWN:
                        value = now[0, u] if side == 0 else before[side, u]
                        path = steps_now[0, u] if side == 0 else steps_before[side, u]
                    path += abs(int32(grey[y, x]) - int32(grey[v, u]))
                now[side, x], steps_now[side, x] = value, path
            if disparity[y, x] == UNKNOWN:
                for side in range(HALF):
                    values[at, side] = now[side, x]
                    paths[at, side] = uint16(min(steps_now[side, x], int32(LONGEST_PATH)))
                at += step


@njit(**KERNEL)
def _choose_all(disparity, values, paths, seen, columns, out):
    h, w = disparity.shape
    at = 0
    for y in range(h):
        seen_from_the_right(disparity[y], columns, seen)
        for x in range(w):
            if disparity[y, x] == UNKNOWN:
                out[y, x] = _choose(values[0, at], values[1, at], paths[0, at], paths[1, at], x, seen)
                at += 1


@inner()
def _choose(first, last, first_paths, last_paths, x, seen):
    """The candidate of the highest score; UNKNOWN if there is none."""
    row_farthest = min(or_never(first[0]), or_never(last[0]))
    farthest = row_farthest
    for side in range(1, HALF):
        farthest = min(farthest, or_never(first[side]), or_never(last[side]))
    best, best_score = UNKNOWN, np.float32(-1e9)
    for k in range(2 * HALF):
        side = k >> 1
        value = int32(last[side] if k & 1 else first[side])
        path = last_paths[side] if k & 1 else first_paths[side]
        score = _score(value, path, farthest, row_farthest, x, seen)
        score += np.float32(DIAGONAL) if side & 1 else np.float32(0)
        if value != UNKNOWN and score > best_score:
            best, best_score = np.int16(value), score
    return best


@inner()
def _score(value, path, farthest, row_farthest, x, seen):
    column = column_of(x, value, seen.size - 1)
    there = int32(seen[column])
    score = np.float32(PER_10_PX_NEARER / 160) * np.float32(value - farthest)
    score += np.float32(PER_ROOT_OF_GREY) * np.sqrt(np.float32(path))
    score += np.float32(FARTHER_OF_ROW) * np.float32(value <= row_farthest + 8)
    score += np.float32(UNMATCHED_THERE) * np.float32(there == UNKNOWN)
    score += np.float32(BEYOND) * np.float32(there == NEVER)
    contradicted = (there != UNKNOWN) & (there < value) & (not alike(there, value))
    return score + np.float32(CONTRADICTED) * np.float32(contradicted)
