"""Kernels of `local_energy`: a filtered part of a spectrum, squared magnitudes, smoothing."""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba takes the types from the call

from math import exp

import numpy as np

from tangible_core.compiled.compiling import njit


@njit(cache=True, nogil=True, error_model="numpy")
def filter_part(values, shape, first, frequency, along, across, part):
    """Write gain times spectrum, row by row; the half that a real picture's spectrum leaves out is mirrored.

    The gain 2 exp(-(one^2 + two^2) / 2), which keeps a wave's amplitude, has one and two grow evenly down a column:
    each gain is the one above times a ratio, which shrinks by the same factor every time.
    """
    (high, wide), (top, left), (down, right) = shape, first, frequency
    rows, columns = part.shape
    one_step, two_step = along[0] / high, across[0] / high
    bend = -(one_step**2 + two_step**2)
    gain, ratio = np.empty(columns), np.empty(columns)
    for j in range(columns):
        v, u = top / high - down, (left + j) / wide - right
        one, two = along[0] * v + along[1] * u, across[0] * v + across[1] * u
        gain[j] = 2 * exp(-0.5 * (one * one + two * two))
        ratio[j] = exp(0.5 * bend - one * one_step - two * two_step)
    for i in range(rows):
        row, j = (top + i) % high, 0
        while j < columns:
            column = (left + j) % wide
            if 2 * column <= wide:
                run = min(columns - j, wide // 2 + 1 - column)
                _scale(values[row, column : column + run], gain[j : j + run], np.float32(1), part[i, j : j + run])
            else:
                run = min(columns - j, wide - column)
                mirrored = values[(high - row) % high, wide - column - run + 1 : wide - column + 1]
                _scale(mirrored[::-1], gain[j : j + run], np.float32(-1), part[i, j : j + run])
            j += run
        _advance(gain, ratio, exp(bend))


@njit(cache=True, nogil=True)
def _advance(gain, ratio, shrink):
    for j in range(gain.size):
        gain[j] *= ratio[j]
        ratio[j] *= shrink


@njit(cache=True, nogil=True)
def _scale(values, gain, sign, part):
    for j in range(part.size):
        each = np.float32(gain[j])
        part[j] = complex(values[j].real * each, values[j].imag * (sign * each))


@njit(cache=True, nogil=True)
def power(grid):
    """Compute |z|^2 of a contiguous array of complex numbers."""
    rows, columns = grid.shape
    out, parts = np.empty((rows, columns), np.float32), grid.view(np.float32)
    for i in range(rows):
        for j in range(columns):
            out[i, j] = parts[i, 2 * j] * parts[i, 2 * j] + parts[i, 2 * j + 1] * parts[i, 2 * j + 1]
    return out


@njit(cache=True, nogil=True)
def complex_products(one, other):
    """Multiply complex numbers one by one: NumPy fuses multiply and add on some processors."""
    product = np.empty_like(one)
    for i in range(one.shape[0]):
        for j in range(one.shape[1]):
            a, b = one[i, j], other[i, j]
            product[i, j] = complex(a.real * b.real - a.imag * b.imag, a.real * b.imag + a.imag * b.real)
    return product


@njit(cache=True, nogil=True)
def weighted_rows(values, first, weights):
    """Compute weighted sums of rows: out[i] is the sum of weights[i, k] values[first[i] + k]."""
    out = np.zeros((len(first), values.shape[1]), np.float32)
    for i in range(len(first)):
        total = out[i]
        for k in range(weights.shape[1]):
            weight, row = weights[i, k], values[first[i] + k]
            for j in range(row.size):
                total[j] += weight * row[j]
    return out
