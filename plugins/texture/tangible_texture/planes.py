"""Products of planes: features and memberships as (d, n), one row a plane, one column a cell. Compiled by numba.

They are small, and asked for between threads of our own: a BLAS that wakes threads for them costs more than it saves.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba takes the types from the call

import numpy as np
from numba import njit

BLOCK = 1024
"""Columns that are worked on while they are in the cache, and that are summed in single precision."""


@njit(cache=True, nogil=True, fastmath=True)
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


@njit(cache=True, nogil=True, fastmath=True)
def _add_four(weights, planes, out):
    a, b, c, d = np.float32(weights[0]), np.float32(weights[1]), np.float32(weights[2]), np.float32(weights[3])
    for i in range(out.size):
        out[i] += a * planes[0, i] + b * planes[1, i] + c * planes[2, i] + d * planes[3, i]


@njit(cache=True, nogil=True, fastmath=True)
def products(one, other):
    """one (k, n) times the transpose of other (d, n): sums over the columns, float64 (k, d)."""
    found = np.zeros((one.shape[0], other.shape[0]))
    for start in range(0, one.shape[1], BLOCK):
        for k in range(one.shape[0]):
            left = one[k, start : start + BLOCK]
            for d in range(other.shape[0]):
                found[k, d] += dot(left, other[d, start : start + BLOCK])
    return found


@njit(cache=True, nogil=True, fastmath=True)
def scatter(planes, weights):
    """Weighted second moments, sum of w z z' over the columns: float64 (d, d)."""
    size = planes.shape[0]
    found = np.zeros((size, size))
    for start in range(0, planes.shape[1], BLOCK):
        heavy = weights[start : start + BLOCK]
        weighted = np.empty(heavy.size, np.float32)
        for d in range(size):
            plane = planes[d, start : start + BLOCK]
            for i in range(heavy.size):
                weighted[i] = heavy[i] * plane[i]
            for e in range(d + 1):
                found[d, e] += dot(weighted, planes[e, start : start + BLOCK])
    for d in range(size):
        for e in range(d):
            found[e, d] = found[d, e]
    return found


@njit(cache=True, nogil=True, fastmath=True)
def dot(one, other):
    """The sum of products of two rows of float32."""
    total = np.float32(0)
    for i in range(one.size):
        total += one[i] * other[i]
    return total
