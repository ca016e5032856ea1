"""The disparities to try: those asked for, or those that occur."""

import logging
from typing import Literal

from tangible_core.errors import PictureError
from tangible_core.notes import note

from .pairs import Pair
from .search_range import find_range
from .span import Span

log = logging.getLogger(__name__)
Auto = Literal["auto"]


def asked_span(pair: Pair, least: int | Auto, most: int | Auto) -> Span:
    """least..most - 1 px. auto: found on small copies of the pair, or a least of 0 where the most is given.

    Raises: PictureError if these are no disparities.
    """
    if most == "auto":
        return _found(pair, least).within(pair.width)
    low = 0 if least == "auto" else least
    if low >= most:
        raise PictureError(f"no disparity is in {low}..{most - 1} px; raise max_disparity_px or lower min_disparity_px")
    return Span(low, most - 1).within(pair.width)


def _found(pair: Pair, least: int | Auto) -> Span:
    found = find_range(pair)
    low, high = (0, 15) if found is None else found.span
    if found is not None and found.swapped:
        note(log, "every disparity is negative: the views seem to be exchanged (left is right)", logging.WARNING)
        high = min(high, 0)
    if least != "auto":
        low, high = least, max(high, least)
    note(log, f"skipped: disparities outside {low}..{high} px, which do not occur")
    return Span(low, high).filled() if high > 0 else Span(low, high)
