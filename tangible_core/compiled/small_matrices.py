"""Symmetric matrices of up to a hundred rows, in float64. Compiled by numba.

LAPACK wakes threads for such matrices, which cost up to ten times what they save next to other working threads, and
its last bits depend on the processor.
"""

# pyright: basic

import numpy as np

from .compiling import njit

ROUNDS = 50  # the most QL steps for one eigenvalue; two or three are usual
# The share of the neighbouring diagonal values below which an off-diagonal value counts as zero.
CLEAN = 1e-15


@njit(cache=True, nogil=True)
def eigen(matrix):
    """Return eigenvalues, largest first, and eigenvectors as rows, by Householder reflections and implicit QL.

    Source: Golub & Van Loan, Matrix Computations, 4th ed., sec. 8.3.
    """
    diagonal, off, vectors = _tridiagonal(matrix)
    for first in range(len(diagonal)):
        for _ in range(ROUNDS):
            last = first
            while last + 1 < len(diagonal):
                if abs(off[last]) <= CLEAN * (abs(diagonal[last]) + abs(diagonal[last + 1])):
                    break
                last += 1
            if last == first:
                break
            _ql_step(diagonal, off, vectors, first, last)
    order = np.argsort(-diagonal)
    return diagonal[order], vectors[order]


@njit(cache=True, nogil=True)
def _tridiagonal(matrix):
    """Return the diagonal of V matrix V', the off-diagonal (with one more 0), and V; sums run along rows."""
    size = len(matrix)
    rest, vectors, off = matrix.astype(np.float64), np.eye(size), np.zeros(size)
    for k in range(size - 2):
        # Householder: a reflection takes row k to its first off-diagonal element. The sign is the one that does not
        # cancel.
        mirror = rest[k, k + 1 :].copy()
        length = np.sqrt(_dot(mirror, mirror))
        off[k] = -length if mirror[0] >= 0 else length
        mirror[0] -= off[k]
        square = _dot(mirror, mirror)
        if square == 0:
            continue
        reflection, vector_reflection = np.zeros(mirror.size), np.zeros(size)
        for i in range(mirror.size):
            _add(reflection, mirror[i], rest[k + 1 + i, k + 1 :])
            _add(vector_reflection, mirror[i], vectors[k + 1 + i])
        reflection *= 2 / square
        _add(reflection, -_dot(reflection, mirror) / square, mirror)
        for i in range(mirror.size):
            _add(rest[k + 1 + i, k + 1 :], -mirror[i], reflection)
            _add(rest[k + 1 + i, k + 1 :], -reflection[i], mirror)
            _add(vectors[k + 1 + i], -2 / square * mirror[i], vector_reflection)
    if size > 1:
        off[size - 2] = rest[size - 2, size - 1]
    return np.diag(rest).copy(), off, vectors


@njit(cache=True, nogil=True)
def _ql_step(diagonal, off, vectors, first, last):
    """Do one implicit QL step on rows first..last, shifted by the nearest eigenvalue of their first two rows."""
    slant = (diagonal[first + 1] - diagonal[first]) / (2 * off[first])
    root = np.sqrt(slant * slant + 1)
    bulge = diagonal[last] - diagonal[first] + off[first] / (slant + (root if slant >= 0 else -root))
    s, c, shift = 1.0, 1.0, 0.0
    for i in range(last - 1, first - 1, -1):
        away, near = s * off[i], c * off[i]
        length = np.sqrt(away * away + bulge * bulge)
        off[i + 1] = length
        if length == 0:  # the matrix falls apart here
            diagonal[i + 1] -= shift
            off[last] = 0
            return
        s, c = away / length, bulge / length
        own = diagonal[i + 1] - shift
        change = (diagonal[i] - own) * s + 2 * c * near
        shift = s * change
        diagonal[i + 1] = own + shift
        bulge = c * change - near
        _rotate(vectors[i], vectors[i + 1], s, c)
    diagonal[first] -= shift
    off[first], off[last] = bulge, 0


@njit(cache=True, nogil=True)
def _rotate(one, other, s, c):
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
def cholesky(matrix):
    """Return the lower Cholesky factor L of matrix = L L'; pivots are at least 1e-12."""
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
def whiten(factor, rows):
    """Return L^-1 x for every row x."""
    result = rows.copy()
    for row in result:
        for i in range(row.size):
            for m in range(i):
                row[i] -= factor[i, m] * row[m]
            row[i] /= factor[i, i]
    return result


@njit(cache=True, nogil=True)
def solve(matrix, rows):
    """Return matrix^-1 x for every row x; the matrix must be positive definite."""
    factor = cholesky(matrix)
    result = whiten(factor, rows)
    for row in result:
        for i in range(row.size - 1, -1, -1):
            row[i] /= factor[i, i]
            for m in range(i):
                row[m] -= factor[i, m] * row[i]
    return result
