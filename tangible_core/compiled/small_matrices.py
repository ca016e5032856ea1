"""Symmetric matrices of up to a hundred rows, in float64. Compiled by numba.

LAPACK wakes threads for them, which cost more than they save: ten times, where other threads are at work; and its last
bits are those of the processor.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba takes the types from the call
# pyright: basic

import numpy as np
from numba import njit

from . import compiling as compiling  # says so while the kernels are compiled

ROUNDS = 50
"""Of QL for one eigenvalue, at most; two or three are the rule."""
CLEAN = 1e-15
"""Beside the diagonal, what is less than this share of the values on it is nothing."""


@njit(cache=True, nogil=True)
def eigen(matrix):
    """Eigenvalues, the largest first, and eigenvectors, one a row: Householder's reflections, then implicit QL.

    Source: Golub & Van Loan, Matrix Computations, 4th ed., sec. 8.3.
    """
    diagonal, beside, vectors = _tridiagonal(matrix)
    for first in range(len(diagonal)):
        for _ in range(ROUNDS):
            last = first
            while last + 1 < len(diagonal):
                if abs(beside[last]) <= CLEAN * (abs(diagonal[last]) + abs(diagonal[last + 1])):
                    break
                last += 1
            if last == first:
                break
            _ql_step(diagonal, beside, vectors, first, last)
    order = np.argsort(-diagonal)
    return diagonal[order], vectors[order]


@njit(cache=True, nogil=True)
def _tridiagonal(matrix):
    """The diagonal of V matrix V', what is beside it (one 0 more), and the rows V; sums run along rows."""
    size = len(matrix)
    rest, vectors, beside = matrix.astype(np.float64), np.eye(size), np.zeros(size)
    for k in range(size - 2):
        mirror = rest[k, k + 1 :].copy()
        length = np.sqrt(_dot(mirror, mirror))
        beside[k] = -length if mirror[0] >= 0 else length
        mirror[0] -= beside[k]
        square = _dot(mirror, mirror)
        if square == 0:
            continue
        turned, mixed = np.zeros(mirror.size), np.zeros(size)
        for i in range(mirror.size):
            _add(turned, mirror[i], rest[k + 1 + i, k + 1 :])
            _add(mixed, mirror[i], vectors[k + 1 + i])
        turned *= 2 / square
        _add(turned, -_dot(turned, mirror) / square, mirror)
        for i in range(mirror.size):
            _add(rest[k + 1 + i, k + 1 :], -mirror[i], turned)
            _add(rest[k + 1 + i, k + 1 :], -turned[i], mirror)
            _add(vectors[k + 1 + i], -2 / square * mirror[i], mixed)
    if size > 1:
        beside[size - 2] = rest[size - 2, size - 1]
    return np.diag(rest).copy(), beside, vectors


@njit(cache=True, nogil=True)
def _ql_step(diagonal, beside, vectors, first, last):
    """One implicit step on rows first..last, shifted by the eigenvalue of their first two that is nearest."""
    slant = (diagonal[first + 1] - diagonal[first]) / (2 * beside[first])
    root = np.sqrt(slant * slant + 1)
    bulge = diagonal[last] - diagonal[first] + beside[first] / (slant + (root if slant >= 0 else -root))
    s, c, shift = 1.0, 1.0, 0.0
    for i in range(last - 1, first - 1, -1):
        away, near = s * beside[i], c * beside[i]
        length = np.sqrt(away * away + bulge * bulge)
        beside[i + 1] = length
        if length == 0:  # the matrix falls apart here
            diagonal[i + 1] -= shift
            beside[last] = 0
            return
        s, c = away / length, bulge / length
        own = diagonal[i + 1] - shift
        change = (diagonal[i] - own) * s + 2 * c * near
        shift = s * change
        diagonal[i + 1] = own + shift
        bulge = c * change - near
        _turn(vectors[i], vectors[i + 1], s, c)
    diagonal[first] -= shift
    beside[first], beside[last] = bulge, 0


@njit(cache=True, nogil=True)
def _turn(one, other, s, c):
    for i in range(one.size):
        a, b = one[i], other[i]
        one[i] = c * a - s * b
        other[i] = s * a + c * b


@njit(cache=True, nogil=True)
def _add(row, weight, other):
    for i in range(row.size):
        row[i] += weight * other[i]


@njit(cache=True, nogil=True)
def _dot(one, other):
    total = 0.0
    for i in range(one.size):
        total += one[i] * other[i]
    return total


@njit(cache=True, nogil=True)
def factored(matrix):
    """L of L L' = matrix, Cholesky's lower factor; a direction of no extent is given next to none."""
    size = len(matrix)
    factor = np.zeros((size, size))
    for i in range(size):
        for j in range(i + 1):
            value = matrix[i, j]
            for m in range(j):
                value -= factor[i, m] * factor[j, m]
            factor[i, j] = np.sqrt(max(value, 1e-12)) if i == j else value / factor[j, j]
    return factor


@njit(cache=True, nogil=True)
def whitened(factor, rows):
    """L^-1 x of every row x."""
    found = rows.copy()
    for row in found:
        for i in range(row.size):
            for m in range(i):
                row[i] -= factor[i, m] * row[m]
            row[i] /= factor[i, i]
    return found


@njit(cache=True, nogil=True)
def solved(matrix, rows):
    """matrix^-1 x of every row x; the matrix is positive definite."""
    factor = factored(matrix)
    found = whitened(factor, rows)
    for row in found:
        for i in range(row.size - 1, -1, -1):
            row[i] /= factor[i, i]
            for m in range(i):
                row[m] -= factor[i, m] * row[i]
    return found
