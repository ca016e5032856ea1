"""Gaps of a disparity map, filled from the surfaces next to them: the entry to this room."""

from typing import Literal

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int16, int32, uint16

from tangible_core.compiled import KERNEL, LATE_STEPS, in_blocks, inner, njit, wait_for

from ...simd.lane_reductions import total
from ...simd.lanes import Lanes, add, load, minimum, multiply, splat, subtract
from ..span import UNKNOWN
from .eight_directions import fill_from_eight_directions
from .four_directions import fill_from_four_directions

# The option `effort` of `semi-global`; all other methods fill as `balanced`.
Effort = Literal["balanced", "best"]
EVERY = 4
COUNT = 12  # samples near a pixel along either axis that are used
# Columns of the samples, in half samples from their middle; negative ones wrap, as all sums do.
COLUMNS = np.arange(1 - COUNT, COUNT, 2).astype(np.uint16)
OF_SURFACE, OF_GREY = 36, 30
"""Largest difference to a known pixel of the same surface, in sixteenths of a pixel and in grey levels."""
# Ridge added to the variance of the positions, in square half samples; that is 48 where all samples are known.
RIDGE = 1.0
FEWEST = 4
# Disparity, in sixteenths of a pixel, from which a value is kept: 16 bits could turn it into UNKNOWN.
FARTHEST_OFF = 32000


def fill_gaps(
    matches: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"], effort: Effort = "balanced"
) -> Int16[np.ndarray, "h w"]:
    """Fill every UNKNOWN pixel of a map in sixteenths of a pixel; best: from eight directions, on planes."""
    wait_for(LATE_STEPS)
    if effort == "best":
        return fit_planes(matches, fill_from_eight_directions(matches, grey), grey)
    return fill_from_four_directions(matches, grey)


def made_up_matches() -> tuple[Int16[np.ndarray, "h w"], UInt8[np.ndarray, "h w"]]:
    """Return a small map with gaps, and a left view that is read-only as that of a `Pair`: kernels depend on it."""
    rows, columns = np.indices((64, 96))
    gaps = (rows // 5 + columns // 7) % 3 == 0
    grey = (rows + columns).astype(np.uint8)
    grey.flags.writeable = False
    return np.where(gaps, UNKNOWN, 16 + columns // 20 * 32).astype(np.int16), grey


def fit_planes(
    disparity: Int16[np.ndarray, "h w"], dense: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]
) -> Int16[np.ndarray, "h w"]:
    """Put each pixel of `filled` that is UNKNOWN in `disparity` onto its surface's plane; sixteenths of a pixel."""
    out = dense.copy()
    samples = slice(EVERY // 2, None, EVERY), slice(EVERY // 2, None, EVERY)
    samples_u16 = np.pad(disparity[samples], COUNT // 2, constant_values=UNKNOWN).view(np.uint16)
    levels = np.pad(grey[samples].astype(np.uint16), COUNT // 2)

    def block(y0: int, y1: int) -> None:
        _fit_rows(disparity, dense, grey, samples_u16, levels, COLUMNS, Lanes(COUNT), y0, y1, out)

    in_blocks(dense.shape[0], block)
    return out


@njit(**KERNEL)
def _fit_rows(disparity, dense, grey, samples, levels, columns, lanes, y0, y1, out):
    for y in range(y0, y1):
        for x in range(dense.shape[1]):
            if disparity[y, x] == UNKNOWN and abs(int32(dense[y, x])) < FARTHEST_OFF:
                out[y, x] = _fit_pixel(samples, levels, columns, lanes, y, x, int32(dense[y, x]), int32(grey[y, x]))


@inner()
def _fit_pixel(disparities, levels, columns, lanes, y, x, value, level):
    """Return the value at (y, x) of the plane through the samples near it of similar value and grey level."""
    # Positions i (columns, one a lane) and j (rows) are in half samples, odd numbers from the middle; v is the
    # difference of a sample to the value. Every sum fits into 16 bits. A ridge keeps the slopes near 0 where the
    # samples lie too close together to determine them.
    top, left = y // EVERY, x // EVERY
    least, darkest = splat(lanes, uint16(OF_SURFACE - value)), splat(lanes, uint16(OF_GREY - level))
    middle = splat(lanes, uint16(OF_SURFACE))
    n = nj = njj = v = vj = splat(lanes, uint16(0))
    for row in range(COUNT):
        at = (top + row) * disparities.shape[1] + left
        more = add(load(lanes, disparities, at), least)
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
    """Return 1 where an unsigned number is in 0..2 reach, 0 elsewhere."""
    bound = splat(lanes, uint16(2 * reach + 1))
    return minimum(subtract(bound, minimum(shifted, bound)), splat(lanes, uint16(1)))


@inner()
def _sum(lanes):
    return np.float64(int16(total(lanes)))


@inner()
def _half_samples(pixel, first):
    """Return the distance of a pixel from the middle of its samples, given the index of the first sample."""
    return (pixel - EVERY * first) * np.float64(2 / EVERY)
