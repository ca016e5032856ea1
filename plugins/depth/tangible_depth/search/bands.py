"""A pair seen in a few bands of rows at full width: enough to tell its range, and whether its rows correspond.

Thin near things stay what they are along a row, and a band of rows averages noise and small offsets of rows away.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, Int64
from numba import njit

from tangible_core.compiled.compiling import KERNEL, inner

from ..dense.confidence import FLAT_REACH
from ..dense.span import UNKNOWN, Span
from ..dense.speckles import remove_speckles
from ..sgm.census import BLOCK, OFFSETS, PLANES, RADIUS, code_rows
from ..sgm.costs import SHARP
from .pairs import Pair
from .sparse_sweep import sweep_columns

COUNT = 16
"""Bands of a picture."""
FINE_WIDTH, MOST_DISPARITIES = 1280, 256
HIGH_PX = 3
"""Rows of the picture that make one row of a band."""
TALL = 2 * RADIUS + 1
"""Rows of a band: what a code looks at."""
STRIDE, LEAST_STRIDDEN = 3, 200
"""Every how many columns are matched, of bands from so many columns on."""
LARGEST_SPECK = 8
"""Of so few rows: what is thin and near has hardly more in them."""


class Bands(NamedTuple):
    """What was matched in some bands: `rows`, their middles in the picture, and the disparity of the left view there.

    disparity, in sixteenths of a pixel of the picture divided by `factor` along its rows; known, of how many pixels;
    loss, the share of matches that no neighbour confirmed (they are left out).
    """

    rows: Int64[np.ndarray, "bands"]
    disparity: Int16[np.ndarray, "bands columns"]
    factor: int
    known: int
    loss: float


def match_bands(pair: Pair, span: Span, width: int = FINE_WIDTH) -> Bands:
    """Match COUNT bands of a pair; as many columns are averaged into one as make it at most `width` wide.

    Of many columns every STRIDE-th one is matched, and speaks for those beside it.
    span: in pixels of the picture. Where it holds more than MOST_DISPARITIES, more columns are averaged.
    """
    factor = max(-(-pair.width // width), -(-span.size // MOST_DISPARITIES))
    columns = -(-pair.width // factor)
    stride = STRIDE if columns >= LEAST_STRIDDEN else 1
    rows = np.empty(COUNT, np.int64)
    codes = np.empty((2, COUNT, PLANES, columns + -columns % BLOCK), np.uint8)
    grey = np.empty((COUNT, -(-columns // stride)), np.uint8)
    flat = np.empty((COUNT, columns), np.bool_)
    total = np.empty(columns * factor, np.int32)
    band = np.empty((TALL, codes.shape[3] + 2 * RADIUS), np.uint8)
    _see(pair.left, pair.right, factor, OFFSETS, stride, total, band, rows, codes, grey, flat)
    disparity = np.empty((COUNT, columns), np.int16)
    sweep_columns(codes[0], codes[1], grey, span.shrunk(factor).within(columns), SHARP.penalties, stride, disparity)
    found = _without_flat(flat, disparity)
    lost = remove_speckles(disparity, LARGEST_SPECK)
    return Bands(rows, disparity, factor, found - lost, lost / max(1, found))


@njit(**KERNEL)
def _see(left, right, factor, offsets, stride, total, band, rows, codes, grey, flat):
    """The middle rows of the bands, their codes in both views, and of the left one the grey values and what is flat."""
    for i in range(rows.size):
        rows[i] = (2 * i + 1) * left.shape[0] // (2 * rows.size)
        _see_band(right, rows[i], factor, offsets, flat.shape[1], total, band, codes[1, i : i + 1])
        _see_band(left, rows[i], factor, offsets, flat.shape[1], total, band, codes[0, i : i + 1])
        for x in range(grey.shape[1]):
            grey[i, x] = band[RADIUS, RADIUS + x * stride]
        _flat_columns(band, flat[i])


@inner()
def _see_band(view, row, factor, offsets, columns, total, band, codes):
    for j in range(TALL):
        _average(view, row + (j - RADIUS) * HIGH_PX, factor, columns, total, band[j])
    for plane in range(PLANES):
        for x in range(codes.shape[2]):
            codes[0, plane, x] = 0
    code_rows(band, offsets, 0, 0, 1, codes)


@inner()
def _average(view, middle, factor, columns, total, means):
    """Each a mean of HIGH_PX x factor pixels round row `middle`; beyond the picture its edge repeats."""
    h, w = view.shape
    scale = np.float32(1 / (HIGH_PX * factor))
    for x in range(total.size):
        total[x] = 0
    for y in range(middle - HIGH_PX // 2, middle - HIGH_PX // 2 + HIGH_PX):
        line = view[min(max(y, 0), h - 1)]
        for x in range(w):
            total[x] += line[x]
    for x in range(w, total.size):
        total[x] = total[w - 1]
    if factor > 1:
        for x in range(columns):
            whole = np.int32(0)
            for i in range(x * factor, (x + 1) * factor):
                whole += total[i]
            total[x] = whole
    for x in range(columns):
        means[RADIUS + x] = np.uint8(total[x] * scale + np.float32(0.5))
    for x in range(RADIUS):
        means[x] = means[RADIUS]
    for x in range(RADIUS + columns, means.size):
        means[x] = means[RADIUS + columns - 1]


@inner()
def _flat_columns(band, flat):
    """As `flat_pixels` of the band's middle row."""
    for x in range(flat.size):
        flat[x] = True
    for j in range(TALL):
        line = band[j]
        for x in range(flat.size):
            level = True
            for k in range(1, 2 * FLAT_REACH + 1):
                level &= line[x] == line[x + k]
            flat[x] &= level


@njit(**KERNEL)
def _without_flat(flat, disparity):
    """Make what is flat UNKNOWN; how many others are known."""
    known = 0
    for y in range(disparity.shape[0]):
        for x in range(disparity.shape[1]):
            value = UNKNOWN if flat[y, x] else disparity[y, x]
            disparity[y, x] = value
            known += value != UNKNOWN
    return known
