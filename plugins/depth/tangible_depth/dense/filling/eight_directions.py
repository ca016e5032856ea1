"""Filling from eight directions, for `effort: best`: as `four_directions`, with the four diagonals as well."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int32, uint16

from tangible_core.compiled import KERNEL, in_blocks, in_turns, inner, njit

from ..span import UNKNOWN
from .candidates import GEODESIC_SCORE, geodesic_candidates, known_or_nearest, project_to_right, score_candidate
from .four_directions import fill_from_four_directions

DIAGONAL_SCORE = -0.9
# Directions of one scan: within the row, straight up, and two diagonals; the scan back has the opposite ones.
HALF = 4
LONGEST_PATH = 65535  # longest path told apart, in grey levels: 16 bits


def fill_from_eight_directions(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> np.ndarray:
    """Fill every UNKNOWN pixel of a map in sixteenths of a pixel; a map without any known pixel stays as it is."""
    h, w = disparity.shape
    before = np.concatenate([[0], np.cumsum(np.count_nonzero(disparity == UNKNOWN, axis=1))])
    missing = int(before[-1])
    if missing in (0, disparity.size):
        return disparity.copy()
    values, paths = np.empty((2, missing, HALF), np.int16), np.empty((2, missing, HALF), np.uint16)

    def look(ends: Iterable[tuple[int, int]]) -> None:
        for end, step in ends:
            values_above, steps = np.empty((2, HALF, w), np.int16), np.empty((2, HALF, w), np.int32)
            _scan(disparity, grey, step, values_above, steps, values[end], paths[end])

    in_turns([(0, 1), (1, -1)], look)
    out = disparity.copy()
    geodesic = geodesic_candidates(disparity, grey)

    def choose(y0: int, y1: int) -> None:
        nearest, columns = np.empty(w + 2, np.int16), np.empty(w, np.int32)
        _choose_rows(disparity, values, paths, *geodesic, nearest, columns, y0, y1, before[y0], out)

    in_blocks(h, choose)
    return fill_from_four_directions(out, grey)  # some have no known pixel in any direction


@njit(**KERNEL)
def _scan(disparity, grey, step, values_above, steps, values, paths):
    """Find the candidates of each UNKNOWN pixel in four directions, scanning from the first (step 1) or last pixel."""
    h, w = disparity.shape
    at = 0 if step > 0 else values.shape[0] - 1
    for i in range(h):
        y = i if step > 0 else h - 1 - i
        before, now = values_above[(i + 1) & 1], values_above[i & 1]
        steps_before, steps_now = steps[(i + 1) & 1], steps[i & 1]
        for j in range(w):
            x = j if step > 0 else w - 1 - j
            # A known neighbour begins a path; an unknown one hands on its own, kept for the row above and the pixel
            # before.
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
def _choose_rows(disparity, values, paths, first, ends, lengths, nearest, columns, y0, y1, at, out):
    """Fill rows y0..y1-1, whose first UNKNOWN pixel is number `at`."""
    w = disparity.shape[1]
    for y in range(y0, y1):
        project_to_right(disparity[y], columns, nearest)
        for x in range(w):
            if disparity[y, x] == UNKNOWN:
                geodesic, length = (ends[y, x], lengths[y, x]) if x < first[y] else (UNKNOWN, int32(0))
                out[y, x] = _choose(values[:, at], paths[:, at], geodesic, length, x, nearest)
                at += 1


@inner()
def _choose(values, paths, geodesic, length, x, nearest):
    row_farthest = min(known_or_nearest(values[0, 0]), known_or_nearest(values[1, 0]))
    farthest = min(row_farthest, known_or_nearest(geodesic))
    for side in range(1, HALF):
        farthest = min(farthest, known_or_nearest(values[0, side]), known_or_nearest(values[1, side]))
    best, best_score = (
        geodesic,
        score_candidate(int32(geodesic), length, farthest, row_farthest, x, nearest) + np.float32(GEODESIC_SCORE),
    )
    for k in range(2 * HALF):
        end, side = k & 1, k >> 1
        value = int32(values[end, side])
        score = score_candidate(value, paths[end, side], farthest, row_farthest, x, nearest)
        score += np.float32(DIAGONAL_SCORE) * np.float32(side & 1)
        if value != UNKNOWN and score > best_score:
            best, best_score = np.int16(value), score
    return best
