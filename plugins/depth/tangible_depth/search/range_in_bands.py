"""Which disparities occur in a pair, found in a few bands of it."""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

from math import ceil, floor
from typing import NamedTuple

import numpy as np
from numba import njit

from tangible_core.compiled.compiling import KERNEL

from ..dense.span import UNKNOWN, Span
from .bands import FINE_WIDTH, Bands, match_bands
from .pairs import Pair

FIRST_WIDTH, REACH = 80, 0.36
"""Width of the first copy, and the largest disparity of either sign in widths of the picture."""
THIN_REACH = 1 / 8
"""Disparities, in widths of the picture, that the second copy tries at least: things too thin for the first stand out
from what is behind them by less than this."""
FRINGE = 0.0005
"""Share of the matches left out at either end as errors."""
NOISY = 0.6
"""Share of matches that no neighbour confirms from which the first copy, which averages noise away, counts as well."""
FIRST_MARGIN, MARGIN = 1, 2
"""What is then added at either end, in pixels of the copy."""
LARGEST = np.int16(32767)


class RangeEstimate(NamedTuple):
    """The range of a pair, and the bands in which it was found."""

    span: Span
    bands: Bands
    swapped: bool
    """Whether every disparity is negative, which parallel cameras in the right order cannot give."""


def reach_px(width: int) -> int:
    """The largest disparity of either sign that a picture of this width is searched for."""
    return round(REACH * width)


def find_range(pair: Pair) -> RangeEstimate | None:
    """The disparities that occur, of either sign; None if nothing at all matches."""
    width, reach = pair.width, reach_px(pair.width)
    first = _look(pair, Span(-reach, reach), FIRST_WIDTH, FIRST_MARGIN)
    if first is None:
        return None
    low, high = first.span
    span = Span(low, max(high, low + round(THIN_REACH * width)))
    fine = _look(pair, span, FINE_WIDTH, MARGIN)
    if fine is None or fine.bands.loss < NOISY:
        return fine or first
    wider = Span(min(first.span.low, fine.span.low), max(first.span.high, fine.span.high))
    return RangeEstimate(wider, fine.bands, first.swapped and fine.swapped)


def _look(pair: Pair, span: Span, width: int, margin: int) -> RangeEstimate | None:
    bands = match_bands(pair, span.within(pair.width), width)
    factor = bands.factor
    if bands.known == 0:
        return None
    extremes = np.empty((2, 1 + int(FRINGE * bands.known)), np.int16)
    _find_extremes(bands.disparity, *extremes)
    low, high = (int(each[-1]) * factor / 16 for each in extremes)
    span = Span(floor(low) - margin * factor, ceil(high) + margin * factor)
    return RangeEstimate(span, bands, low < -2 and high <= 1)


@njit(**KERNEL)
def _find_extremes(disparity, lowest, highest):
    """The lowest known disparities, in rising order, and the highest, in falling order."""
    lowest[:], highest[:] = LARGEST, UNKNOWN
    for y in range(disparity.shape[0]):
        for x in range(disparity.shape[1]):
            value = disparity[y, x]
            if value != UNKNOWN and value < lowest[-1]:
                i = lowest.size - 1
                while i > 0 and lowest[i - 1] > value:
                    lowest[i] = lowest[i - 1]
                    i -= 1
                lowest[i] = value
            if value > highest[-1]:
                i = highest.size - 1
                while i > 0 and highest[i - 1] < value:
                    highest[i] = highest[i - 1]
                    i -= 1
                highest[i] = value
