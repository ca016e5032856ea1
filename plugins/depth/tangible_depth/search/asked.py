"""The disparities to try: those asked for, or those that occur."""

import logging
from typing import Literal, NamedTuple

from tangible_core.errors import PictureError
from tangible_core.plugins.notes import note

from ..dense.span import Span
from .bands import Bands
from .pairs import Pair
from .search_range import find_range, reach_px

log = logging.getLogger(__name__)
Auto = Literal["auto"]


class SearchRange(NamedTuple):
    """The disparities to try, and what was matched to find them, if they were not told."""

    span: Span
    bands: Bands | None


def asked_span(pair: Pair, least: int | Auto, most: int | Auto) -> SearchRange:
    """least..most - 1 px. auto: found in a few bands of the pair, or a least of 0 where the most is given.

    Raises: PictureError if these are no disparities.
    """
    if most == "auto":
        return _found(pair, least)
    low = 0 if least == "auto" else least
    if low >= most:
        raise PictureError(
            f"the search range {low}..{most - 1} px is empty; raise max_disparity_px or lower min_disparity_px"
        )
    return SearchRange(Span(low, most - 1).within(pair.width), None)


def _found(pair: Pair, least: int | Auto) -> SearchRange:
    found = find_range(pair)
    low, high = (0, reach_px(pair.width)) if found is None else found.span
    if found is not None and found.swapped:
        note(log, "every disparity is negative: the views seem to be exchanged (left is right)", logging.WARNING)
        high = min(high, 0)
    if least != "auto":
        low, high = least, max(high, least)
    why = "beyond what is searched where nothing stands out" if found is None else "which do not occur"
    note(log, f"skipped: disparities outside {low}..{high} px, {why}")
    span = Span(low, high).filled() if high > 0 else Span(low, high)
    return SearchRange(span.within(pair.width), found and found.bands)
