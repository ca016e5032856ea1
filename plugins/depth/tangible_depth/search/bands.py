"""Matches in a few bands of rows at full width: enough for the search range, and to check that rows correspond."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, Int64

from tangible_core.compiled import KERNEL, inner, njit

from ..dense.confidence import FLAT_REACH
from ..dense.span import UNKNOWN, Span
from ..dense.speckles import remove_speckles
from ..sgm.costs import BLOCK, OFFSETS, PLANES, RADIUS, SHARP, code_rows
from .pairs import Pair
from .sparse_sweep import sweep_columns

COUNT = 16
FINE_WIDTH = 1280
# Largest number of disparities tried in a band: of more, columns are averaged.
MAX_DISPARITIES = 256
HIGH_PX = 3  # rows of the picture averaged into one row of a band
TALL = 2 * RADIUS + 1  # rows of a band: the window of a census code
STRIDE = 3
MIN_STRIDDEN = 200
# Largest speckle, in pixels of the bands: thin near objects have hardly more in so few rows.
LARGEST_SPECK = 8


class Bands(NamedTuple):
    """The matches in a few bands, in sixteenths of a pixel of the picture downsampled by `factor` along its rows."""

    rows: Int64[np.ndarray, "bands"]
    disparity: Int16[np.ndarray, "bands columns"]
    factor: int
    match_count: int
    loss: float


def match_bands(pair: Pair, span: Span, width: int = FINE_WIDTH) -> Bands:
    """Match COUNT bands of a pair; columns are averaged until a band is at most `width` wide."""
    # Thin near objects keep their width along a row, and a band of rows averages noise and small row offsets away.
    factor = max(-(-pair.width // width), -(-span.size // MAX_DISPARITIES))
    columns = -(-pair.width // factor)
    # The columns next to a matched one take its disparity.
    stride = STRIDE if columns >= MIN_STRIDDEN else 1
    rows = np.empty(COUNT, np.int64)
    codes = np.empty((2, COUNT, PLANES, columns + -columns % BLOCK), np.uint8)
    grey = np.empty((COUNT, -(-columns // stride)), np.uint8)
    flat = np.empty((COUNT, columns), np.bool_)
    total = np.empty(columns * factor, np.int32)
    band = np.empty((TALL, codes.shape[3] + 2 * RADIUS), np.uint8)
    _encode_bands(pair.left, pair.right, factor, OFFSETS, stride, total, band, rows, codes, grey, flat)
    disparity = np.empty((COUNT, columns), np.int16)
    sweep_columns(codes[0], codes[1], grey, span.downsample(factor).within(columns), SHARP.penalties, stride, disparity)
    disparity[flat] = UNKNOWN
    match_count = int(np.count_nonzero(disparity != UNKNOWN))
    speckle_count = remove_speckles(disparity, LARGEST_SPECK)
    return Bands(rows, disparity, factor, match_count - speckle_count, speckle_count / max(1, match_count))


@njit(**KERNEL)
def _encode_bands(left, right, factor, offsets, stride, total, band, rows, codes, grey, flat):
    """Write the bands' middle rows, their codes in both views, and the left view's grey values and flat pixels."""
    for i in range(rows.size):
        rows[i] = (2 * i + 1) * left.shape[0] // (2 * rows.size)
        _encode_band(right, rows[i], factor, offsets, flat.shape[1], total, band, codes[1, i : i + 1])
        _encode_band(left, rows[i], factor, offsets, flat.shape[1], total, band, codes[0, i : i + 1])
        for x in range(grey.shape[1]):
            grey[i, x] = band[RADIUS, RADIUS + x * stride]
        _find_flat_columns(band, flat[i])


@inner()
def _encode_band(view, row, factor, offsets, columns, total, band, codes):
    for j in range(TALL):
        _average_rows(view, row + (j - RADIUS) * HIGH_PX, factor, columns, total, band[j])
    code_rows(band, offsets, 0, 0, 1, codes)


@inner()
def _average_rows(view, middle, factor, columns, total, means):
    """Average HIGH_PX x factor pixels near row `middle` into each value; the picture's edge is repeated outwards."""
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
    # In place: a sum is written over a pixel that no later sum reads.
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
def _find_flat_columns(band, flat):
    for x in range(flat.size):
        flat[x] = True
    for j in range(TALL):
        line = band[j]
        for x in range(flat.size):
            level = True
            for k in range(1, 2 * FLAT_REACH + 1):
                level &= line[x] == line[x + k]
            flat[x] &= level
