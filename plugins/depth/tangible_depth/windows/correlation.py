"""Comparison of windows at every disparity: zero-mean normalised cross-correlation and squared differences."""

from typing import NamedTuple

import numpy as np
from numba import float32, int32

from tangible_core.compiled import inner, njit

from ..dense.span import UNKNOWN
from ..simd.lane_reductions import first_equal, first_lane, highest
from ..simd.lanes import add, larger, load, multiply, shift_down, splat, store, subtract, to_float, widen, width

OUT = np.float32(-1e30)  # score of a window beyond the picture or without texture


class Sliding(NamedTuple):
    """The entering row and the leaving one, zeros without one; those of the right view are shifted by `top`."""

    left: np.ndarray
    right: np.ndarray
    gone_left: np.ndarray
    gone_right: np.ndarray


class Windows(NamedTuple):
    """The sums of the windows of a row, by their centres, and the scale and offset of their scores."""

    total: np.ndarray
    scale: np.ndarray
    offset: np.ndarray


@inner()
def parabola(before, at, after):
    """Return the vertex of the parabola through three samples, within +-0.5 of the best; 0 if they lie on a line."""
    bend = (before - at) + (after - at)
    return (before - after) / (bend + bend) if bend != 0 else bend


@inner()
def _products(lanes, left, right, x):
    """Return left[x] right[x + k - top]; `right` is shifted already."""
    return multiply(splat(lanes, int32(left[x])), widen(load(lanes, right, x)))


@inner()
def _slide(lanes, rows, x, column):
    """Update column[x]: add the products of the entering row, subtract those of the leaving one."""
    # Done when the column is needed next, so that it is read and written once per row of windows.
    n = width(lanes)
    here = add(load(lanes, column, x * n), _products(lanes, rows.left, rows.right, x))
    here = subtract(here, _products(lanes, rows.gone_left, rows.gone_right, x))
    store(column, x * n, here)
    return here


@njit(nogil=True, boundscheck=False)
def _set(left, right, top, out_left, out_right):
    """Copy one row of both views; of the right one the part that the lanes reach, shifted by `top`."""
    for x in range(left.size):
        out_left[x] = left[x]
        if 0 <= x + top < out_right.size:
            out_right[x + top] = right[x]


@njit(nogil=True, boundscheck=False)
def _add_moments(row, sign, sums, squares):
    for x in range(row.size):
        value = int32(row[x])
        sums[x] += sign * value
        squares[x] += sign * value * value


@njit(nogil=True, boundscheck=False, error_model="numpy")
def _describe(is_squared, sums, squares, radius, least_variance, first, windows):
    """Write the window centred on column x, from the sums of columns, to first + x; flat ones get the offset OUT."""
    w = sums.size
    area = (2 * radius + 1) ** 2
    total = square = np.int64(0)
    for x in range(-radius, w - radius):
        total += sums[x + radius]
        square += squares[x + radius]
        if x < radius:
            continue
        if 0 <= first + x < windows.total.size:
            spread = area * square - total * total
            is_textured = spread > least_variance * area * area
            windows.total[first + x] = total
            windows.offset[first + x] = (
                OUT if not is_textured else float32(0) if is_squared is None else -float32(square)
            )
            windows.scale[first + x] = 1 / np.sqrt(float32(spread)) if is_textured else 0
        total -= sums[x - radius]
        square -= squares[x - radius]


@njit(nogil=True, boundscheck=False)
def _decide(lanes, is_squared, rows, column, left, right, radius, unused, scores, best, tops, right_tops):
    """Compute the scores of a row; the best lane and score of each left pixel, the best score of each right pixel."""
    # The score is the covariance over both deviations, -1..1, or if `squared` minus the sum of squared differences.
    # Sums of products may wrap; the covariance, their difference, fits 32 bits for windows up to 19 x 19.
    n = width(lanes)
    w = best.size
    area = splat(lanes, int32((2 * radius + 1) ** 2))
    window = splat(lanes, int32(0))
    for x in range(min(2 * radius, w)):
        window = add(window, _slide(lanes, rows, x, column))
    running_best = splat(lanes, OUT)
    out = splat(lanes, OUT)
    for x in range(radius, w - radius):
        window = add(window, _slide(lanes, rows, x + radius, column))
        offset = add(load(lanes, right.offset, x), load(lanes, unused, 0))
        if is_squared is None:
            products = multiply(splat(lanes, left.total[x]), load(lanes, right.total, x))
            covariance = to_float(subtract(multiply(area, window), products))
            score = multiply(multiply(covariance, load(lanes, right.scale, x)), splat(lanes, left.scale[x]))
        else:
            score = add(to_float(add(window, window)), splat(lanes, left.offset[x]))
        score = add(score, offset)
        store(scores, x * n, score)
        tops[x] = highest(score)
        best[x] = first_equal(score, tops[x])
        running_best = larger(running_best, score)
        right_tops[x] = first_lane(running_best)
        running_best = shift_down(running_best, out)
        window = subtract(window, load(lanes, column, (x - radius) * n))
    for i in range(n - 1):
        right_tops[w - radius + i] = first_lane(running_best)
        running_best = shift_down(running_best, out)


@njit(nogil=True, boundscheck=False, error_model="numpy")
def _accept(n, span, least, left, scores, best, tops, right_tops, radius, disparity):
    """Accept disparities of mutual best pixels, refined by the parabola through three scores."""
    disparity[:] = UNKNOWN
    for x in range(radius, best.size - radius):
        k, at = best[x], tops[x]
        if left.offset[x] <= OUT or at <= least or at < right_tops[x + k]:
            continue
        move = float32(0)
        if 0 < k < span.high - span.low:
            before, after = scores[x * n + k - 1], scores[x * n + k + 1]
            if before == at and after == at:
                continue
            if min(before, after) > OUT / 2:
                move = parabola(before, at, after)
        disparity[x] = np.int16(np.floor(16 * (float32(span.high - k) - move) + float32(0.5)))


@njit(nogil=True, boundscheck=False, cache=True)
def correlate_strip(lanes, is_squared, left, right, rows, radius, span, least, least_variance, disparity, tops):
    """Write disparities in sixteenths of a pixel (UNKNOWN if rejected) and winners' scores of rows[0]..rows[1]-1."""
    n = width(lanes)
    h, w = left.shape
    # Window sums are exact integers that slide: down by adding the products of the entering row and subtracting those
    # of the leaving one, sideways by one column in and one out, for all disparities at once; no step depends on the
    # window's size. Lane k stands for the disparity top - k, so that the right view's column is x + k - top.
    column = np.zeros(w * n, np.int32)
    moments = np.zeros((4, w), np.int32)
    sliding = Sliding(
        np.zeros(w, np.uint8), np.zeros(w + n - 1, np.uint8), np.zeros(w, np.uint8), np.zeros(w + n - 1, np.uint8)
    )
    on_left = Windows(np.zeros(w, np.int32), np.zeros(w, np.float32), np.full(w, OUT))
    on_right = Windows(np.zeros(w + n - 1, np.int32), np.zeros(w + n - 1, np.float32), np.full(w + n - 1, OUT))
    unused = np.where(np.arange(n) <= span.high - span.low, float32(0), OUT)
    scores, best, right_tops = np.zeros(w * n, np.float32), np.zeros(w, np.int64), np.full(w + n, OUT)
    for y in range(rows[0] - radius, rows[1] + radius):
        row, leaving = min(max(y, 0), h - 1), y - 2 * radius - 1
        _set(left[row], right[row], span.high, sliding.left, sliding.right)
        _add_moments(left[row], 1, moments[0], moments[1])
        _add_moments(right[row], 1, moments[2], moments[3])
        if leaving >= rows[0] - radius:
            row = min(max(leaving, 0), h - 1)
            _set(left[row], right[row], span.high, sliding.gone_left, sliding.gone_right)
            _add_moments(left[row], -1, moments[0], moments[1])
            _add_moments(right[row], -1, moments[2], moments[3])
        centre = y - radius
        if centre < rows[0]:
            for x in range(w):
                _slide(lanes, sliding, x, column)
            continue
        _describe(is_squared, moments[0], moments[1], radius, least_variance, 0, on_left)
        _describe(is_squared, moments[2], moments[3], radius, least_variance, span.high, on_right)
        _decide(
            lanes,
            is_squared,
            sliding,
            column,
            on_left,
            on_right,
            radius,
            unused,
            scores,
            best,
            tops[centre],
            right_tops,
        )
        _accept(n, span, least, on_left, scores, best, tops[centre], right_tops, radius, disparity[centre])
