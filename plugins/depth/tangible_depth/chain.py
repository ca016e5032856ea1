"""What all dense matchers do round their matching: the range, exchanged views, and the map in pixels."""

from collections.abc import Callable

import numpy as np

from tangible_core.data import DisparityMap

from .asked import Auto, asked_span
from .confidence import flat_pixels
from .dense import Dense, as_map
from .pairs import Pair
from .raw_pairs import check_rows
from .span import Span

Matcher = Callable[[Pair, Span], Dense]


def disparity_map(pair: Pair, least: int | Auto, most: int | Auto, fill: bool, match: Matcher) -> DisparityMap:
    """Match a pair within the disparities asked for.

    Where these are negative throughout, the views are exchanged: mirrored they are a pair in the right order, in which
    what is hidden lies on the side where the matchers expect it.
    """
    span, bands = asked_span(pair, least, most)
    pair = check_rows(pair, span, bands)
    if span.high > 0 or pair.width == 1:
        return as_map(match(pair, span), pair.left, fill)
    flipped = pair.mirrored()
    found = as_map(match(flipped, Span(-span.high, -span.low)), flipped.left, fill)
    return DisparityMap(-found.disparity_px[:, ::-1], found.confidence[:, ::-1])


def nothing_moved(pair: Pair, fill: bool) -> DisparityMap:
    """The map of two identical views: 0 everywhere, and nothing known where nothing changes along the rows."""
    flat = flat_pixels(pair.left)
    unknown = flat & (not fill or bool(flat.all()))
    return DisparityMap(np.where(unknown, np.float32(np.nan), np.float32(0)), (~flat).astype(np.float32))
