"""Products of planes: features and memberships as (d, n), one row a plane, one column a cell. Compiled by numba.

They are small, and asked for between threads of our own: a BLAS that wakes threads for them costs more than it saves.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba takes the types from the call

import numpy as np
from numba import njit

BLOCK = 1024
"""Columns that are worked on while they are in the cache."""
SUMMED = 128
"""Columns that are summed in single precision; what they come to is summed in double."""
EIGHT = 8
"""Columns that are added at a time: sums are written an eighth as often."""


@njit(cache=True, nogil=True)
def mixed(weights, planes):
    """weights (k, d) times planes (d, n): k planes, float32."""
    found = np.zeros((weights.shape[0], planes.shape[1]), np.float32)
    for start in range(0, planes.shape[1], BLOCK):
        part = planes[:, start : start + BLOCK]
        for k in range(weights.shape[0]):
            out = found[k, start : start + BLOCK]
            for d in range(0, part.shape[0] - 3, 4):  # four at a time: sums are written a fourth as often
                _add_four(weights[k, d : d + 4], part[d : d + 4], out)
            for d in range(part.shape[0] // 4 * 4, part.shape[0]):
                weight, plane = np.float32(weights[k, d]), part[d]
                for i in range(out.size):
                    out[i] += weight * plane[i]
    return found


@njit(cache=True, nogil=True)
def _add_four(weights, planes, out):
    a, b, c, d = np.float32(weights[0]), np.float32(weights[1]), np.float32(weights[2]), np.float32(weights[3])
    for i in range(out.size):
        out[i] += a * planes[0, i] + b * planes[1, i] + c * planes[2, i] + d * planes[3, i]


@njit(cache=True, nogil=True)
def products(one, other):
    """one (k, n) times the transpose of other (d, n): sums over the columns, float64 (k, d)."""
    found = np.zeros((one.shape[0], other.shape[0]))
    for start in range(0, one.shape[1], SUMMED):
        left, right = one[:, start : start + SUMMED], _upright(other[:, start : start + SUMMED])
        for k in range(one.shape[0]):
            _add_rows(left[k], right, found[k])
    return found


@njit(cache=True, nogil=True)
def scatter(planes, weights):
    """Weighted second moments, sum of w z z' over the columns: float64 (d, d)."""
    size = planes.shape[0]
    found = np.zeros((size, size))
    for start in range(0, planes.shape[1], SUMMED):
        heavy, part = weights[start : start + SUMMED], planes[:, start : start + SUMMED]
        upright = _upright(part)
        for d in range(size):
            _add_rows(heavy * part[d], upright, found[d, : d + 1])
    for d in range(size):
        for e in range(d):
            found[e, d] = found[d, e]
    return found


@njit(cache=True, nogil=True)
def _upright(part):
    """The columns as rows, filled up to a whole number of EIGHT with zeros."""
    count = part.shape[1]
    found = np.zeros((count + -count % EIGHT, part.shape[0]), np.float32)
    for d in range(part.shape[0]):
        for i in range(count):
            found[i, d] = part[d, i]
    return found


@njit(cache=True, nogil=True)
def _add_rows(weights, rows, found):
    """Add the weighted sum of rows, in single precision, to what was found: as many values as that has.

    Every value is summed in the order of the rows, side by side with the others: no order depends on how many values
    the processor works on at once.
    """
    size, count = found.size, rows.shape[0]
    total, heavy = np.zeros(size, np.float32), np.zeros(count, np.float32)
    for i in range(weights.size):
        heavy[i] = weights[i]
    for i in range(0, count, EIGHT):
        a, b, c, d = heavy[i], heavy[i + 1], heavy[i + 2], heavy[i + 3]
        e, f, g, h = heavy[i + 4], heavy[i + 5], heavy[i + 6], heavy[i + 7]
        r, s, t, u, v, w, x, y = (rows[i], rows[i + 1], rows[i + 2], rows[i + 3], rows[i + 4], rows[i + 5],
            rows[i + 6], rows[i + 7])  # fmt: skip
        for j in range(size):
            total[j] = (total[j] + a * r[j] + b * s[j] + c * t[j] + d * u[j] + e * v[j] + f * w[j] + g * x[j]
                + h * y[j])  # fmt: skip
    for j in range(size):
        found[j] += total[j]
