"""The disparities that occur in a few bands of a pair."""

# ruff: noqa: ANN001, ANN202 -- numba infers the types of kernels; their docstrings give them

from math import ceil, floor
from typing import NamedTuple

import numpy as np

from tangible_core.compiled.compiling import KERNEL, njit

from ..dense.span import UNKNOWN, Span
from .bands import FINE_WIDTH, Bands, match_bands
from .pairs import Pair

FIRST_WIDTH = 80
"""Width of the first copy, in columns."""
REACH = 0.36
"""Largest disparity of either sign, as a share of the picture's width, unless something stands still nearer."""
FAR_REACH, MIN_REVEALED = 0.8, 0.015
"""Largest disparity that is tried for things still nearer, as a share of the width, and the smallest share of the
matches that must lie beyond REACH, at places without a match within it, for such a thing to be there."""
THIN_REACH = 1 / 8
"""Smallest range of the second copy, as a share of the picture's width: objects too thin for the first copy stand out
from their background by less than this."""
FRINGE = 0.0005
"""Share of the matches dropped at either end as errors."""
NOISY = 0.6
"""Loss (share of speckles) from which the first copy, which averages noise away, counts as well."""
FIRST_MARGIN, MARGIN = 1, 2
"""Margins added to the range of the first and second copy at either end, in pixels of the copy."""
LARGEST = np.int16(32767)
"""Disparity above every real one."""


class RangeEstimate(NamedTuple):
    """The range of a pair, and the bands that it was estimated in."""

    span: Span
    bands: Bands
    swapped: bool
    """True if every disparity is negative, which parallel cameras in the right order cannot produce."""


def reach_px(width: int) -> int:
    """Return the largest disparity of either sign to try in a picture of this width."""
    return round(REACH * width)


def far_reach_px(width: int) -> int:
    """Return the largest disparity of either sign at which anything is looked for."""
    return round(FAR_REACH * width)


def find_range(pair: Pair) -> RangeEstimate | None:
    """Estimate the disparities that occur, of either sign; None if nothing matches."""
    width, reach = pair.width, reach_px(pair.width)
    far = far_reach_px(width)
    first = _range_of_bands(pair, Span(-reach, reach), FIRST_WIDTH, FIRST_MARGIN)
    wide = _range_of_bands(pair, Span(-far, far), FIRST_WIDTH, FIRST_MARGIN)
    if wide is not None and _revealed_share(wide.bands, first and first.bands, reach) >= MIN_REVEALED:
        first = wide
    if first is None:
        return None
    low, high = first.span
    span = Span(low, max(high, low + round(THIN_REACH * width)))
    fine = _range_of_bands(pair, span, FINE_WIDTH, MARGIN)
    if fine is None or fine.bands.loss < NOISY:
        return fine or first
    wider = Span(min(first.span.low, fine.span.low), max(first.span.high, fine.span.high))
    return RangeEstimate(wider, fine.bands, first.swapped and fine.swapped)


def _revealed_share(wide: Bands, near: Bands | None, reach: int) -> float:
    """Return the share of the matches that lie beyond `reach`, where the bands of a search within it have no match."""
    revealed = (wide.disparity != UNKNOWN) & (np.abs(wide.disparity * (wide.factor / 16)) > reach)
    if near is not None:
        revealed &= near.disparity == UNKNOWN
    return float(np.count_nonzero(revealed) / max(1, wide.known))


def _range_of_bands(pair: Pair, span: Span, width: int, margin: int) -> RangeEstimate | None:
    bands = match_bands(pair, span.clip(pair.width), width)
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
    """Find the lowest known disparities, in rising order, and the highest, in falling order."""
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
