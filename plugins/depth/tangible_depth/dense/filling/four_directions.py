"""Filling from four directions, for `effort: balanced` and for all methods other than `semi-global`."""

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int32

from tangible_core.compiled import KERNEL, in_blocks, inner, njit

from ..span import UNKNOWN
from .candidates import (
    GEODESIC_SCORE,
    NEAREST,
    SAME_SURFACE,
    geodesic_candidates,
    known_or_nearest,
    project_to_right,
    score_candidate,
)

LEFT, RIGHT, ABOVE, BELOW, GEODESIC = range(5)  # indices of the candidates
# Widest gap, in columns, that takes the farther end without scoring if both ends are of one surface.
SHORT = 2


def fill_from_four_directions(
    disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]
) -> Int16[np.ndarray, "h w"]:
    """Fill every UNKNOWN pixel of a map in sixteenths of a pixel; a map without any known pixel stays as it is."""
    dense, left_over = _fill_once(disparity, grey)
    if 0 < left_over < dense.size:  # some have no known pixel in their row and column
        dense, _ = _fill_once(dense, grey)
    return dense


def _fill_once(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> tuple[np.ndarray, int]:
    """Return the filled map, and the number of pixels left UNKNOWN."""
    out = np.empty_like(disparity)
    geodesic = geodesic_candidates(disparity, grey)
    left_over: list[int] = []

    def block(y0: int, y1: int) -> None:
        left_over.append(_fill_rows(disparity, grey, y0, y1, geodesic, _scratch(y1 - y0, disparity.shape[1]), out))

    in_blocks(disparity.shape[0], block)
    return out, sum(left_over)


def _scratch(rows: int, w: int) -> tuple[np.ndarray, ...]:
    of_sides, of_below = (GEODESIC + 1, w), (rows, w)
    return (
        np.empty(of_sides, np.int16),
        np.empty(of_sides, np.int32),
        np.empty(of_below, np.int16),
        np.empty(of_below, np.int32),
        np.empty(w + 2, np.int16),
        np.empty(w, np.int32),
        np.empty(w + 1, np.int64),
        np.empty(w, np.bool_),
    )


@njit(**KERNEL)
def _fill_rows(disparity, grey, y0, y1, geodesic, scratch, out):
    """Fill rows y0..y1-1; return the number of their pixels left UNKNOWN."""
    w = disparity.shape[1]
    left_over = 0
    sides, paths, below, below_path, nearest, columns, edges, missing = scratch
    # ABOVE runs downwards with y: its path starts where each column last had a known value, even above this block, so
    # that blocks are independent. BELOW is found for all rows at once by one scan upwards.
    _scan_up(disparity, grey, y0, y1, below, below_path, sides[ABOVE], paths[ABOVE], missing)
    _start(sides[ABOVE], paths[ABOVE])
    for y in range(max(_reach(disparity, y0 - 1, -1, missing), 0), y0 - 1):
        _carry(disparity[y], grey[y], grey[y + 1], sides[ABOVE], paths[ABOVE])
    for y in range(y0, y1):
        if y > 0:
            _carry(disparity[y - 1], grey[y - 1], grey[y], sides[ABOVE], paths[ABOVE])
        _copy(below[y - y0], sides[BELOW])
        _copy(below_path[y - y0], paths[BELOW])
        _copy(disparity[y], out[y])
        project_to_right(disparity[y], columns, nearest)
        for gap in range(0, _edges_of_gaps(disparity[y], edges), 2):
            start, stop = edges[gap], edges[gap + 1]
            if (
                stop - start <= SHORT
                and start > 0
                and stop < w
                and abs(int32(disparity[y, start - 1]) - int32(disparity[y, stop])) <= SAME_SURFACE
            ):
                for x in range(start, stop):  # one of the many gaps between whole disparities
                    out[y, x] = min(disparity[y, start - 1], disparity[y, stop])
            else:
                _scan_gap(disparity[y], grey[y], start, stop, sides, paths)
                _offer_geodesic(geodesic, y, start, stop, sides, paths)
                for x in range(start, stop):
                    out[y, x] = choose_of_four(sides, paths, x, nearest)
                    left_over += out[y, x] == UNKNOWN
    return left_over


@inner()
def choose_of_four(sides, paths, x, nearest):
    """Return the candidate of the highest score; UNKNOWN without one."""
    left, right, above, below = sides[LEFT, x], sides[RIGHT, x], sides[ABOVE, x], sides[BELOW, x]
    geodesic = sides[GEODESIC, x]
    row_farthest = min(known_or_nearest(left), known_or_nearest(right))
    farthest = min(row_farthest, known_or_nearest(above), known_or_nearest(below), known_or_nearest(geodesic))
    if farthest == NEAREST:
        return UNKNOWN
    if max(left, right, above, below, geodesic) - farthest <= SAME_SURFACE:
        return np.int16(farthest if row_farthest == NEAREST else row_farthest)
    best, best_score = UNKNOWN, np.float32(-1e9)
    for side in range(GEODESIC + (geodesic != UNKNOWN)):
        value = int32(sides[side, x])
        score = score_candidate(value, paths[side, x], farthest, row_farthest, x, nearest)
        score += np.float32(GEODESIC_SCORE) * np.float32(side == GEODESIC)
        best = np.int16(value) if score > best_score else best
        best_score = max(score, best_score)
    return best


@inner()
def _edges_of_gaps(row, edges):
    """Write each gap's first column and the one after its last; return their number. Without unpredictable branches."""
    count = 0
    inside = False
    for x in range(row.size):
        edges[count] = x
        count += (row[x] == UNKNOWN) != inside
        inside = row[x] == UNKNOWN
    edges[count] = row.size
    return count + inside


@inner()
def _copy(row, out):
    """Copy a row; numba's `out[:] = row` is slower, as it is not vectorised."""
    for x in range(row.size):
        out[x] = row[x]


@inner()
def _carry(row, grey, next_grey, latest, path):
    """Step from one row to the next: a known pixel starts a new path, all other paths go on."""
    for x in range(row.size):
        is_valid = row[x] != UNKNOWN
        latest[x] = row[x] if is_valid else latest[x]
        path[x] = (int32(0) if is_valid else path[x]) + abs(int32(grey[x]) - int32(next_grey[x]))


@inner()
def _start(latest, path):
    for x in range(latest.size):
        latest[x] = UNKNOWN
        path[x] = 0


@inner()
def _scan_up(disparity, grey, y0, y1, below, path, latest, steps, missing):
    """Find the nearest known value below each pixel of rows y0..y1-1, and the grey steps on the path."""
    h = disparity.shape[0]
    _start(latest, steps)
    last = min(_reach(disparity, y1, 1, missing), h - 1)
    for i in range(last - y0 + 1):
        y = last - i
        if y + 1 < h:
            _carry(disparity[y + 1], grey[y + 1], grey[y], latest, steps)
        if y < y1:
            _copy(latest, below[y - y0])
            _copy(steps, path[y - y0])


@inner()
def _reach(disparity, y, step, missing):
    """Return the row at which, from row y on, every column has had a known value; beyond the picture without one."""
    for x in range(missing.size):
        missing[x] = True
    while 0 <= y < disparity.shape[0]:
        count = 0
        for x in range(missing.size):
            missing[x] &= disparity[y, x] == UNKNOWN
            count += missing[x]
        if count == 0:
            break
        y += step
    return y


@inner()
def _scan_gap(row, grey, start, stop, sides, paths):
    """Offer the known pixels at both ends of a gap to each pixel in it."""
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


@inner()
def _offer_geodesic(geodesic, y, start, stop, sides, paths):
    """Offer the geodesic candidates to each pixel of a gap; there are some at the left border only."""
    for x in range(start, stop):
        at_border = x < geodesic.first[y]
        sides[GEODESIC, x] = geodesic.values[y, x] if at_border else UNKNOWN
        paths[GEODESIC, x] = geodesic.lengths[y, x] if at_border else int32(0)
