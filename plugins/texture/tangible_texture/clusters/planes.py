"""Products of planes: features and memberships as (d, n), one row a plane, one column a cell. Compiled by numba."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float32, Float64

from tangible_core.compiled import in_turns, njit, thread_count

BLOCK = 1024  # the number of columns processed while they are in the cache
SHARED = 4_000_000  # the number of multiplications from which threads pay
# The number of columns summed in single precision; their sums are added in double precision.
SUMMED = 4096
# The number of parallel partial sums: a constant, so that the order of sums is the same on every processor.
LANES = 64


@njit(cache=True, nogil=True)
def combine_planes(weights, planes):
    """Multiply weights (k, d) by planes (d, n): k planes, float32."""
    result = np.zeros((weights.shape[0], planes.shape[1]), np.float32)
    add_planes(weights, planes, result)
    return result


@njit(cache=True, nogil=True)
def add_planes(weights, planes, result):
    """Add weights (k, d) times planes (d, n) to k planes, in place: four planes to two at a time."""
    # Planes are small and interleaved with our own threads: a BLAS that wakes threads for them costs more than it
    # saves. A value of the result is the same however many are added at a time.
    (count, size), columns = weights.shape, planes.shape[1]
    for start in range(0, columns, BLOCK):
        stop = min(start + BLOCK, columns)
        for d in range(0, size - 3, 4):
            one, two, three, four = (
                planes[d, start:stop],  # row by row: numba does not know a block of a matrix to be contiguous
                planes[d + 1, start:stop],
                planes[d + 2, start:stop],
                planes[d + 3, start:stop],
            )
            for k in range(0, count - 1, 2):
                out, other = result[k, start:stop], result[k + 1, start:stop]
                _add_four_to_two(weights[k : k + 2, d : d + 4], one, two, three, four, out, other)
            if count % 2:
                _add_four(weights[count - 1, d : d + 4], one, two, three, four, result[count - 1, start:stop])
        for d in range(size // 4 * 4, size):
            for k in range(count):
                _add_one(weights[k, d], planes[d, start:stop], result[k, start:stop])


@njit(cache=True, nogil=True)
def _add_four_to_two(weights, one, two, three, four, out, other):
    (a, b, c, d), (e, f, g, h) = _single(weights[0]), _single(weights[1])
    for i in range(out.size):
        p, q, r, s = one[i], two[i], three[i], four[i]
        out[i] += a * p + b * q + c * r + d * s
        other[i] += e * p + f * q + g * r + h * s


@njit(cache=True, nogil=True)
def _add_four(weights, one, two, three, four, out):
    a, b, c, d = _single(weights)
    for i in range(out.size):
        out[i] += a * one[i] + b * two[i] + c * three[i] + d * four[i]


@njit(cache=True, nogil=True)
def _single(weights):
    return np.float32(weights[0]), np.float32(weights[1]), np.float32(weights[2]), np.float32(weights[3])


@njit(cache=True, nogil=True)
def _add_one(weight, plane, out):
    single = np.float32(weight)
    for i in range(out.size):
        out[i] += single * plane[i]


@njit(cache=True, nogil=True)
def inner_products(one, other):
    """Multiply one (k, n) by the transpose of other (d, n): sums over the columns, float64 (k, d)."""
    result, lanes = np.zeros((one.shape[0], other.shape[0])), np.empty(LANES, np.float32)
    for start in range(0, one.shape[1], SUMMED):
        for k in range(one.shape[0]):
            left = one[k, start : start + SUMMED]
            for d in range(other.shape[0]):
                result[k, d] += _dot(left, other[d, start : start + SUMMED], lanes)
    return result


def scatter_matrix(planes: Float32[np.ndarray, "d n"], weights: Float32[np.ndarray, "n"]) -> Float64[np.ndarray, "d d"]:
    """Compute weighted second moments, the sum of w z z' over the columns; large ones on all processors."""
    size, columns = planes.shape
    parts = thread_count() if size * size * columns >= SHARED else 1
    result = np.zeros((size, size))

    def work(share: Iterable[int]) -> None:
        for first in share:
            _scatter_rows(planes, weights, first, parts, result)

    in_turns(list(range(parts)), work)
    return _mirror_lower_triangle(result)


@njit(cache=True, nogil=True)
def scatter_matrix_in_kernel(planes, weights):
    """Compute `scatter_matrix` on the calling thread alone, for use in a kernel."""
    result = np.zeros((planes.shape[0], planes.shape[0]))
    _scatter_rows(planes, weights, 0, 1, result)
    return _mirror_lower_triangle(result)


@njit(cache=True, nogil=True)
def _scatter_rows(planes, weights, first, step, result):
    """Fill every step-th row from `first` on of the lower triangle; no sum depends on the step."""
    lanes = np.empty(LANES, np.float32)
    for start in range(0, planes.shape[1], SUMMED):
        heavy = weights[start : start + SUMMED]
        for d in range(first, planes.shape[0], step):
            products = heavy * planes[d, start : start + SUMMED]
            for e in range(d + 1):
                result[d, e] += _dot(products, planes[e, start : start + SUMMED], lanes)


@njit(cache=True, nogil=True)
def _mirror_lower_triangle(result):
    for d in range(result.shape[0]):
        for e in range(d):
            result[e, d] = result[d, e]
    return result


@njit(cache=True, nogil=True)
def _dot(one, other, lanes):
    """Sum the products of two rows of float32 in LANES partial sums."""
    # The order of the sums is that of the source, however many values the processor adds at once.
    whole = one.size // (8 * LANES) * (8 * LANES)
    lanes[:] = 0
    for start in range(0, whole, 8 * LANES):  # eight at a time: an eighth of the writes
        for j in range(LANES):
            i = start + j
            lanes[j] = (
                lanes[j]
                + one[i] * other[i]
                + one[i + LANES] * other[i + LANES]
                + one[i + 2 * LANES] * other[i + 2 * LANES]
                + one[i + 3 * LANES] * other[i + 3 * LANES]
                + one[i + 4 * LANES] * other[i + 4 * LANES]
                + one[i + 5 * LANES] * other[i + 5 * LANES]
                + one[i + 6 * LANES] * other[i + 6 * LANES]
                + one[i + 7 * LANES] * other[i + 7 * LANES]
            )
    for start in range(whole, one.size, LANES):
        left, right = one[start : start + LANES], other[start : start + LANES]
        for j in range(left.size):
            lanes[j] += left[j] * right[j]
    for j in range(LANES // 2):
        lanes[j] += lanes[j + LANES // 2]
    for j in range(LANES // 4):
        lanes[j] += lanes[j + LANES // 4]
    total = 0.0
    for j in range(LANES // 4):
        total += lanes[j]
    return total
