"""Which disparities occur in a pair, found on small copies of it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Int16

from .confidence import flat_pixels
from .costs import SHARP
from .pairs import Pair
from .span import UNKNOWN, Span
from .speckles import remove_speckles
from .strips import blank, strips, sweep

TOLERANCE = 1.0
FIRST_WIDTH, REACH = 80, 0.36
"""Width of the first small copy, and the largest disparity of either sign in widths of the picture."""
FINE = 4
"""The second copy is this much smaller than the picture, or larger pictures' copies at most FINE_WIDTH wide."""
FINE_WIDTH = 400
FRINGE, MARGIN_PX = 0.001, 5
"""Share of the matches left out at either end as errors, and what is then added."""


class Found(NamedTuple):
    """The range of a pair and a rough map of it, in sixteenths of a pixel of the picture divided by `factor`."""

    span: Span
    rough: Int16[np.ndarray, "h/factor w/factor"]
    factor: int
    swapped: bool
    """Whether every disparity is negative, which parallel cameras in the right order cannot give."""


def find_range(pair: Pair) -> Found | None:
    """The disparities that occur, of either sign; None if nothing at all matches."""
    width = pair.width
    reach = round(REACH * width)
    factor = -(-width // FIRST_WIDTH)
    found = _look(pair, Span(-reach, reach).within(width), factor)
    fine = max(FINE, -(-width // FINE_WIDTH))
    if found is None or factor <= fine:
        return found
    return _look(pair, Span(found.span.low - factor, found.span.high + factor).within(width), fine) or found


def _look(pair: Pair, span: Span, factor: int) -> Found | None:
    small = pair.shrunk(factor)
    span_small = span.shrunk(factor).within(small.width)
    out = blank(small.left.shape)
    codes = SHARP.codes(small.left), SHARP.codes(small.right)
    sweep(codes, small.left, span_small, SHARP.prices, TOLERANCE, strips(small.left.shape, span_small), out)
    remove_speckles(out.disparity, largest_px=10)
    matched = (out.disparity != UNKNOWN) & ~flat_pixels(small.left)
    known = np.sort(out.disparity[matched]).astype(np.float32) * (factor / 16)
    if known.size == 0:
        return None
    fringe = int(FRINGE * known.size)
    low, high = known[fringe], known[-1 - fringe]
    margin = MARGIN_PX if factor <= 4 else factor + 1
    span = Span(int(np.floor(low - margin)), int(np.ceil(high + margin)))
    return Found(span, out.disparity, factor, bool(low < -2 and high <= 1))
