"""The disparities to try: those asked for, or those that occur."""

import logging
from typing import Literal, NamedTuple

import numpy as np

from tangible_core.errors import PictureError
from tangible_core.plugins.notes import note

from ..dense.span import UNKNOWN, Span
from .bands import Bands
from .pairs import Pair
from .range_in_bands import MARGIN, find_range, reach_px

log = logging.getLogger(__name__)
Auto = Literal["auto"]
LEAST_BEYOND = 0.01
"""Share of the bands' matches that must lie beyond verified ones, on the way to where a range ends, to be followed."""
LEAST_STEP_PX = 8
MOST_FILLED = 256
"""Disparities of a turned pair beyond which what its lanes hold anyway is left: a pair is made smaller for it."""


class SearchRange(NamedTuple):
    """The disparities to try, and what was matched to find them, if they were not told."""

    span: Span
    bands: Bands | None
    notes: tuple[tuple[str, int], ...] = ()
    """What was found, in words, with the level to log it at."""

    def say(self) -> None:
        """Note what was found: for the pair that is matched, and not for one that turns out to need turning first."""
        for message, level in self.notes:
            note(log, message, level)


def asked_span(pair: Pair, least: int | Auto, most: int | Auto, seen_px: tuple[int, int] | None = None) -> SearchRange:
    """least..most - 1 px. auto: found in a few bands of the pair, or a least of 0 where the most is given.

    seen_px: lowest and highest disparity of verified matches. Bands then widen the range only as far as their matches
    go on from there without a gap: some match by chance where a turned picture shows nothing.
    Raises: PictureError if these are no disparities.
    """
    if most == "auto":
        return _found(pair, least, seen_px)
    low = 0 if least == "auto" else least
    if low >= most:
        raise PictureError(
            f"the search range {low}..{most - 1} px is empty; raise max_disparity_px or lower min_disparity_px"
        )
    return SearchRange(Span(low, most - 1).within(pair.width), None)


def _found(pair: Pair, least: int | Auto, seen_px: tuple[int, int] | None) -> SearchRange:
    found = find_range(pair)
    notes: list[tuple[str, int]] = []
    low, high = (0, reach_px(pair.width)) if found is None else found.span
    if found is not None and found.swapped:
        notes.append(("every disparity is negative: the views seem to be exchanged (left is right)", logging.WARNING))
        high = min(high, 0)
    if seen_px is not None:
        low, high = _round_seen(Span(*seen_px), found and found.bands)
    if least != "auto":
        low, high = least, max(high, least)
    why = "beyond what is searched where nothing stands out" if found is None else "which do not occur"
    notes.append((f"skipped: disparities outside {low}..{high} px, {why}", logging.INFO))
    span = Span(low, high)
    if high > 0 and (seen_px is None or span.size <= MOST_FILLED):
        span = span.filled()
    return SearchRange(span.within(pair.width), found and found.bands, tuple(notes))


def _round_seen(seen: Span, bands: Bands | None) -> Span:
    """The range of verified matches, widened at either end as far as matches of the bands go on."""
    step = max(LEAST_STEP_PX, seen.size // 8)
    known = np.empty(0)
    if bands is not None:
        known = np.sort(bands.disparity[bands.disparity != UNKNOWN]) * (bands.factor / 16)
    return Span(-_end(-seen.low, -known[::-1], step), _end(seen.high, known, step))


def _end(last: int, known: np.ndarray, step: int) -> int:
    """From `last`, upwards as long as each step of the sorted `known` holds LEAST_BEYOND of them; and a step more."""
    least = max(1, int(LEAST_BEYOND * known.size))
    end = last
    while np.searchsorted(known, end + step) - np.searchsorted(known, end) >= least:
        end += step
    return end + max(step, MARGIN)
