"""Disparity where none was found, from the nearest known pixels on eight sides: what `effort: best` fills with.

As `filling`, with the four diagonals besides.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from collections.abc import Iterable

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int32, njit, uint16

from tangible_core.compiled.compiling import KERNEL, inner
from tangible_core.compiled.threads import in_blocks, in_turns

from ..span import UNKNOWN
from .candidates import DETOUR, or_never, score, seen_from_the_right
from .four_directions import fill_from_four_directions
from .geodesic import detours

DIAGONAL = -0.9
HALF = 4
"""Sides seen from one end of the picture, mirrored from the other: in the row, straight on, and two diagonals."""
LONGEST_PATH = 65535


def fill_from_eight_directions(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> np.ndarray:
    """The map with every UNKNOWN pixel filled; known pixels keep their value, a map without any stays as it is.

    disparity is in sixteenths of a pixel.
    """
    h, w = disparity.shape
    before = np.concatenate([[0], np.cumsum(np.count_nonzero(disparity == UNKNOWN, axis=1))])
    missing = int(before[-1])
    if missing in (0, disparity.size):
        return disparity.copy()
    values, paths = np.empty((2, missing, HALF), np.int16), np.empty((2, missing, HALF), np.uint16)

    def look(ends: Iterable[tuple[int, int]]) -> None:
        for end, step in ends:
            carried, steps = np.empty((2, HALF, w), np.int16), np.empty((2, HALF, w), np.int32)
            _look(disparity, grey, step, carried, steps, values[end], paths[end])

    in_turns([(0, 1), (1, -1)], look)
    out = disparity.copy()
    found = detours(disparity, grey)

    def choose(y0: int, y1: int) -> None:
        seen, columns = np.empty(w + 2, np.int16), np.empty(w, np.int32)
        _choose_rows(disparity, values, paths, *found, seen, columns, y0, y1, before[y0], out)

    in_blocks(h, choose)
    return fill_from_four_directions(out, grey)  # some saw nothing on any side


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
def _choose_rows(disparity, values, paths, first, detoured, lengths, seen, columns, y0, y1, at, out):
    """Rows y0..y1-1, the first gap of which is number `at`."""
    w = disparity.shape[1]
    for y in range(y0, y1):
        seen_from_the_right(disparity[y], columns, seen)
        for x in range(w):
            if disparity[y, x] == UNKNOWN:
                detour, length = (detoured[y, x], lengths[y, x]) if x < first[y] else (UNKNOWN, int32(0))
                out[y, x] = _choose(values[:, at], paths[:, at], detour, length, x, seen)
                at += 1


@inner()
def _choose(values, paths, detour, length, x, seen):
    """The candidate of the highest score; UNKNOWN if there is none."""
    row_farthest = min(or_never(values[0, 0]), or_never(values[1, 0]))
    farthest = min(row_farthest, or_never(detour))
    for side in range(1, HALF):
        farthest = min(farthest, or_never(values[0, side]), or_never(values[1, side]))
    best, best_score = detour, score(int32(detour), length, farthest, row_farthest, x, seen) + np.float32(DETOUR)
    for k in range(2 * HALF):
        end, side = k & 1, k >> 1
        value = int32(values[end, side])
        rated = score(value, paths[end, side], farthest, row_farthest, x, seen)
        rated += np.float32(DIAGONAL) * np.float32(side & 1)
        if value != UNKNOWN and rated > best_score:
            best, best_score = np.int16(value), rated
    return best
