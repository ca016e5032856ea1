"""Symmetric matrices of up to a hundred rows, in float64. Compiled by numba.

LAPACK wakes threads for them, which cost more than they save: ten times, where other threads are at work; and its last
bits are those of the processor.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba takes the types from the call
# pyright: basic

import numpy as np
from numba import njit

from . import compiling as compiling  # says so while the kernels are compiled

SWEEPS = 30
CLEAN = 1e-11
"""Off the diagonal, what is less than this share of the largest value on it is nothing."""


@njit(cache=True, nogil=True)
def eigen(matrix):
    """Eigenvalues, the largest first, and eigenvectors, one a row: cyclic Jacobi rotations.

    Source: Golub & Van Loan, Matrix Computations, 4th ed., sec. 8.5.
    """
    size = len(matrix)
    rest, vectors = matrix.copy(), np.eye(size)
    least = CLEAN * np.abs(np.diag(matrix)).max()
    for _ in range(SWEEPS):
        turned = False
        for p in range(size - 1):
            for q in range(p + 1, size):
                if abs(rest[p, q]) > least:
                    _rotate(rest, vectors, p, q)
                    turned = True
        if not turned:
            break
    order = np.argsort(-np.diag(rest))
    return np.diag(rest)[order], vectors[order]


@njit(cache=True, nogil=True)
def _rotate(rest, vectors, p, q):
    """Turn axes p and q so that nothing is left between them."""
    slant = (rest[q, q] - rest[p, p]) / (2 * rest[p, q])
    t = (1.0 if slant >= 0 else -1.0) / (abs(slant) + np.sqrt(slant * slant + 1))
    c = 1 / np.sqrt(t * t + 1)
    s = t * c
    between, first, last = rest[p, q], rest[p, p], rest[q, q]
    for rows in (rest, vectors):
        one, other = rows[p], rows[q]
        for i in range(one.size):
            a, b = one[i], other[i]
            one[i] = c * a - s * b
            other[i] = s * a + c * b
    rest[p, p], rest[q, q] = first - t * between, last + t * between
    rest[p, q] = rest[q, p] = 0.0
    rest[:, p] = rest[p]
    rest[:, q] = rest[q]


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
