"""Surfaces go on into gaps as they lie: by the plane through what is known of them.

A gap that is filled with the value of a neighbour is flat, whatever the slope of the surface. Here each filled pixel is
put onto a plane: that of least squares through the known pixels round it that are of its surface, by their disparity
and their grey. A ridge holds the slopes near 0 where these pixels lie too close together to tell them.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int16, int32, njit, uint16

from tangible_core.compiled.compiling import KERNEL, inner
from tangible_core.compiled.threads import in_blocks

from ...simd.lane_reductions import total
from ...simd.lanes import Lanes, add, load, minimum, multiply, splat, subtract
from ..span import UNKNOWN

EVERY, COUNT = 4, 12
"""Every which row and column is sampled, and how many samples round a pixel are looked at either way."""
COLUMNS = np.arange(1 - COUNT, COUNT, 2).astype(np.uint16)
"""The columns of the samples, in half samples from their middle; what is negative wraps, as all sums do."""
OF_SURFACE, OF_GREY = 36, 30
"""Sixteenths of a pixel and grey levels by which a known pixel may differ and still be of the same surface."""
RIDGE = 1.0
"""Square half samples that are added to the variance of the positions, which is 48 where all round is known."""
FEWEST = 4
"""Samples of a surface from which a plane is laid through them."""
FARTHEST_OFF = 32000
"""Sixteenths of a pixel from which a value is left alone: in 16 bits it might be taken for UNKNOWN."""


def fit_planes(
    disparity: Int16[np.ndarray, "h w"], filled: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]
) -> Int16[np.ndarray, "h w"]:
    """`filled`, with what is UNKNOWN in `disparity` put onto the plane of its surface; in sixteenths of a pixel."""
    out = filled.copy()
    samples = slice(EVERY // 2, None, EVERY), slice(EVERY // 2, None, EVERY)
    known = np.pad(disparity[samples], COUNT // 2, constant_values=UNKNOWN).view(np.uint16)
    levels = np.pad(grey[samples].astype(np.uint16), COUNT // 2)

    def block(y0: int, y1: int) -> None:
        _lay(disparity, filled, grey, known, levels, COLUMNS, Lanes(COUNT), y0, y1, out)

    in_blocks(filled.shape[0], block)
    return out


@njit(**KERNEL)
def _lay(disparity, filled, grey, known, levels, columns, lanes, y0, y1, out):
    for y in range(y0, y1):
        for x in range(filled.shape[1]):
            if disparity[y, x] == UNKNOWN and abs(int32(filled[y, x])) < FARTHEST_OFF:
                out[y, x] = _on_plane(known, levels, columns, lanes, y, x, int32(filled[y, x]), int32(grey[y, x]))


@inner()
def _on_plane(known, levels, columns, lanes, y, x, value, level):
    """The plane through the samples round (y, x) that are like its value and grey level, at this pixel.

    Positions i (columns, one a lane) and j (rows) are in half samples, odd numbers from the middle; v is what a sample
    has more than the value. Every sum fits into 16 bits.
    """
    top, left = y // EVERY, x // EVERY
    least, darkest = splat(lanes, uint16(OF_SURFACE - value)), splat(lanes, uint16(OF_GREY - level))
    middle = splat(lanes, uint16(OF_SURFACE))
    n = nj = njj = v = vj = splat(lanes, uint16(0))
    for row in range(COUNT):
        at = (top + row) * known.shape[1] + left
        more = add(load(lanes, known, at), least)
        like = _within(lanes, add(load(lanes, levels, at), darkest), OF_GREY)
        counts = multiply(_within(lanes, more, OF_SURFACE), like)
        more = multiply(counts, subtract(more, middle))
        j = splat(lanes, uint16(2 * row + 1 - COUNT))
        n, nj, njj = add(n, counts), add(nj, multiply(counts, j)), add(njj, multiply(multiply(counts, j), j))
        v, vj = add(v, more), add(vj, multiply(more, j))
    samples = _sum(n)
    if samples < FEWEST:
        return np.int16(value)
    i = load(lanes, columns, 0)
    ni = multiply(n, i)
    mean_i, mean_j, mean_v = _sum(ni) / samples, _sum(nj) / samples, _sum(v) / samples
    ii = _sum(multiply(ni, i)) / samples - mean_i * mean_i + RIDGE
    jj = _sum(njj) / samples - mean_j * mean_j + RIDGE
    ij = _sum(multiply(nj, i)) / samples - mean_i * mean_j
    iv = _sum(multiply(v, i)) / samples - mean_i * mean_v
    jv = _sum(vj) / samples - mean_j * mean_v
    to_i, to_j = _half_samples(x, left) - mean_i, _half_samples(y, top) - mean_j
    slopes = ((jj * iv - ij * jv) * to_i + (ii * jv - ij * iv) * to_j) / (ii * jj - ij * ij)
    return np.int16(min(max(np.rint(value + mean_v + slopes), -32767), 32767))


@inner()
def _within(lanes, shifted, reach):
    """1 where an unsigned number is 0 up to 2 reach, 0 elsewhere."""
    bound = splat(lanes, uint16(2 * reach + 1))
    return minimum(subtract(bound, minimum(shifted, bound)), splat(lanes, uint16(1)))


@inner()
def _sum(lanes):
    return np.float64(int16(total(lanes)))


@inner()
def _half_samples(pixel, first):
    """How far a pixel lies from the middle of its samples, the first of which is at this place among all."""
    return (pixel - EVERY * first) * np.float64(2 / EVERY)
