"""Compiled search for each feature of the left picture along its row of the right one, by correlation."""

import numpy as np

from tangible_core.compiled import njit


@njit(cache=True, nogil=True)
def match_rows(left, right, left_inverse, right_inverse, points, low, high, half, disparity, score):
    """Fill disparity[i], NaN without a match, and score[i] for each point (column, row) of the left picture."""
    # The views are padded by half a window; the inverses are one over the norm of each window minus its mean, 0 for a
    # flat one. A match is dropped if the best right window's own best left window is over a pixel away.
    scores = np.empty(high - low + 1, np.float32)
    window = np.empty((2 * half + 1, 2 * half + 1), np.float32)
    width = left_inverse.shape[1]
    for i in range(len(points)):
        x, y = points[i]
        disparity[i], score[i] = np.nan, 0
        count = _row_scores(left, right, left_inverse, right_inverse, x, y, x - high, x - low, half, window, scores)
        if count == 0:
            continue
        best = np.argmax(scores[:count])
        if scores[best] <= 0:
            continue
        column = max(x - high, 0) + best
        move = _peak(scores, best, count)
        value = scores[best]
        count = _row_scores(
            right, left, right_inverse, left_inverse, column, y, column + low, column + high, half, window, scores
        )
        if count > 0 and abs(max(column + low, 0) + np.argmax(scores[:count]) - x) <= 1 and column < width:
            disparity[i], score[i] = x - column - move, value


@njit(cache=True, nogil=True)
def _row_scores(anchor, other, anchor_inverse, other_inverse, x, y, first, last, half, window, scores):
    """Write to scores[c] the correlations of the anchor's window at (x, y) with the other's at columns first..last."""
    first, last = max(first, 0), min(last, other_inverse.shape[1] - 1)
    count = max(last - first + 1, 0)
    length = anchor_inverse[y, x]
    if count == 0 or length == 0:
        return 0
    side = 2 * half + 1
    window[:] = anchor[y : y + side, x : x + side]
    window -= window.mean()
    scores[:count] = 0
    # Columns innermost: the compiler turns that loop into vector instructions.
    for v in range(side):
        row = other[y + v]
        for u in range(side):
            tap = window[v, u]
            for c in range(count):
                scores[c] += tap * row[first + u + c]
    for c in range(count):
        scores[c] *= length * other_inverse[y, first + c]
    return count


@njit(cache=True, nogil=True)
def _peak(scores, best, count):
    if best == 0 or best == count - 1:
        return np.float32(0)
    bend = 2 * scores[best] - scores[best - 1] - scores[best + 1]
    return np.float32(0.5) * (scores[best + 1] - scores[best - 1]) / bend if bend > 0 else np.float32(0)
