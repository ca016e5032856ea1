"""A pair seen in a few bands of rows at full width: enough to tell its range, and whether its rows correspond.

Thin near things stay what they are along a row, and a band of rows averages noise and small offsets of rows away.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, Int64, UInt8
from numba import njit

from tangible_core.compiled.compiling import KERNEL

from ..dense.confidence import flat_pixels
from ..dense.span import UNKNOWN, Span
from ..dense.speckles import remove_speckles
from ..sgm.census import BLOCK, OFFSETS, PLANES, RADIUS, code_rows
from ..sgm.costs import SHARP
from ..sgm.strips import blank, sweep
from .pairs import Pair

COUNT = 16
"""Bands of a picture."""
FINE_WIDTH, MOST_DISPARITIES = 1280, 256
HIGH_PX = 3
"""Rows of the picture that make one row of a band."""
TALL = 2 * RADIUS + 1
"""Rows of a band: what a code looks at."""
LARGEST_SPECK = 8
"""Of so few rows: what is thin and near has hardly more in them."""
STRICT = 1.0


class Bands(NamedTuple):
    """What was matched in some bands: `rows`, their middles in the picture, and the disparity of the left view there.

    disparity, in sixteenths of a pixel of the picture divided by `factor` along its rows; loss, the share of matches
    that no neighbour confirmed (they are left out).
    """

    rows: Int64[np.ndarray, "bands"]
    disparity: Int16[np.ndarray, "bands columns"]
    factor: int
    loss: float


def match_bands(pair: Pair, span: Span, width: int = FINE_WIDTH) -> Bands:
    """Match COUNT bands of a pair; as many columns are averaged into one as make it at most `width` wide.

    span: in pixels of the picture. Where it holds more than MOST_DISPARITIES, more columns are averaged.
    """
    h, w = pair.left.shape
    factor = max(-(-w // width), -(-span.size // MOST_DISPARITIES))
    rows = ((np.arange(COUNT) + 0.5) * h / COUNT).astype(np.int64)
    left, right = (_averaged(view, rows, factor) for view in pair)
    columns = slice(RADIUS, RADIUS - (-w // factor))
    grey = np.ascontiguousarray(left[:, RADIUS, columns])
    out = blank(grey.shape)
    within = span.shrunk(factor).within(grey.shape[1])
    sweep((_codes(left), _codes(right)), grey, within, SHARP.penalties, STRICT, [(0, COUNT)], out)
    found = np.count_nonzero(out.disparity != UNKNOWN)
    lost = remove_speckles(out.disparity, LARGEST_SPECK)
    flat = flat_pixels(left.reshape(COUNT * TALL, -1))[RADIUS::TALL, columns]
    out.disparity[flat] = UNKNOWN
    return Bands(rows, out.disparity, factor, lost / max(1, found))


def _averaged(view: UInt8[np.ndarray, "h w"], rows: np.ndarray, factor: int) -> UInt8[np.ndarray, "bands 5 padded"]:
    """The bands round some rows, each value a mean of HIGH_PX x factor pixels; beyond the picture its edge repeats."""
    columns = -(-view.shape[1] // factor)
    bands = np.empty((COUNT, TALL, columns + 2 * RADIUS + -columns % BLOCK), np.uint8)
    _average(view, rows, factor, columns, np.empty(columns * factor, np.int32), bands)
    return bands


def _codes(bands: UInt8[np.ndarray, "bands 5 padded"]) -> UInt8[np.ndarray, "bands 3 whole"]:
    """Census codes of the middle rows."""
    codes = np.zeros((COUNT, PLANES, bands.shape[2] - 2 * RADIUS), np.uint8)
    _code(bands, OFFSETS, codes)
    return codes


@njit(**KERNEL)
def _code(bands, offsets, codes):
    for band in range(codes.shape[0]):
        code_rows(bands[band], offsets, 0, 0, 1, codes[band : band + 1])


@njit(**KERNEL)
def _average(view, rows, factor, columns, total, bands):
    h, w = view.shape
    scale = np.float32(1 / (HIGH_PX * factor))
    for band in range(rows.size):
        for j in range(TALL):
            for x in range(total.size):
                total[x] = 0
            first = rows[band] + (j - RADIUS) * HIGH_PX - HIGH_PX // 2
            for y in range(first, first + HIGH_PX):
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
            means = bands[band, j]
            for x in range(columns):
                means[RADIUS + x] = np.uint8(total[x] * scale + np.float32(0.5))
            for x in range(RADIUS):
                means[x] = means[RADIUS]
            for x in range(RADIUS + columns, means.size):
                means[x] = means[RADIUS + columns - 1]
