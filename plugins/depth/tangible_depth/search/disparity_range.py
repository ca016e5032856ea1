"""The search range of a pair: the disparities that were requested, or those that occur."""

import logging
from typing import Literal, NamedTuple

import numpy as np

from tangible_core.errors import PictureError
from tangible_core.plugins.notes import note

from ..dense.span import UNKNOWN, Span
from .bands import Bands
from .pairs import Pair
from .range_in_bands import MARGIN, far_reach_px, find_range, reach_px

log: logging.Logger = logging.getLogger(__name__)
Auto = Literal["auto"]
LEAST_BEYOND = 0.01
"""Lowest share of the bands' matches in a step beyond verified ones that extends the range by that step."""
LEAST_STEP_PX = 8
"""Smallest width, in pixels, of such a step."""
MOST_FILLED = 256
"""Disparities up to which the range of a rectified pair is extended to all lanes: a larger one shrinks the pictures."""

ALL_NEGATIVE = "every disparity is negative, as of exchanged views (left is right) and of pictures that were shifted"


class SearchRange(NamedTuple):
    """The disparities to try, and the bands that were matched to estimate them, None if they were given."""

    span: Span
    bands: Bands | None
    notes: tuple[tuple[str, int], ...] = ()
    """Messages about the estimate, each with its log level."""

    def log_notes(self) -> None:
        """Log the notes. Call it for the pair that is matched, not for one that turns out to need rectification."""
        for message, level in self.notes:
            note(log, message, level)


def find_disparity_range(
    pair: Pair, least: int | Auto, most: int | Auto, verified_px: tuple[int, int] | None = None
) -> SearchRange:
    """Return the range least..most - 1 px; auto: estimated in bands of the pair, or a least of 0 if most is given.

    verified_px: lowest and highest disparity of verified matches. Bands then widen the range only as far as their
    matches continue from there without a gap: some match by chance where a rectified picture is empty.
    Raises: PictureError if the range is empty.
    """
    if most == "auto":
        return _estimate_range(pair, least, verified_px)
    low = 0 if least == "auto" else least
    if low >= most:
        raise PictureError(
            f"the search range {low}..{most - 1} px is empty; raise max_disparity_px or lower min_disparity_px"
        )
    return SearchRange(Span(low, most - 1).clip(pair.width), None)


def _estimate_range(pair: Pair, least: int | Auto, verified_px: tuple[int, int] | None) -> SearchRange:
    estimate = find_range(pair)
    notes: list[tuple[str, int]] = []
    low, high = (0, reach_px(pair.width)) if estimate is None else estimate.span
    if estimate is not None and estimate.swapped:
        notes.append((ALL_NEGATIVE, logging.WARNING))
        high = min(high, 0)
    if verified_px is not None:
        low, high = _range_around_matches(Span(*verified_px), estimate and estimate.bands)
    if least != "auto":
        low, high = least, max(high, least)
    why = (
        "the default range of a pair without matches"
        if estimate is None
        else f"as none was found up to {far_reach_px(pair.width)} px; for nearer things write `max_disparity_px`"
    )
    notes.append((f"skipped: disparities outside {low}..{high} px, {why}", logging.INFO))
    span = Span(low, high)
    if high > 0 and (verified_px is None or span.size <= MOST_FILLED):
        span = span.fill_lanes()
    return SearchRange(span.clip(pair.width), estimate and estimate.bands, tuple(notes))


def _range_around_matches(seen: Span, bands: Bands | None) -> Span:
    """Widen the range of verified matches at either end as far as the matches of the bands continue."""
    step = max(LEAST_STEP_PX, seen.size // 8)
    known = np.empty(0)
    if bands is not None:
        known = np.sort(bands.disparity[bands.disparity != UNKNOWN]) * (bands.factor / 16)
    return Span(-_extend_end(-seen.low, -known[::-1], step), _extend_end(seen.high, known, step))


def _extend_end(last: int, known: np.ndarray, step: int) -> int:
    """Extend `last` upwards while each step holds LEAST_BEYOND of the sorted `known` disparities; then add a step."""
    least = max(1, int(LEAST_BEYOND * known.size))
    end = last
    while np.searchsorted(known, end + step) - np.searchsorted(known, end) >= least:
        end += step
    return end + max(step, MARGIN)
