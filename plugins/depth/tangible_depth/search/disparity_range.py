"""The search range of a pair: the disparities that were requested, or those that occur."""

import logging
from math import ceil, floor
from typing import Literal, NamedTuple

import numpy as np

from tangible_core.errors import PictureError
from tangible_core.plugins import note

from ..dense.span import UNKNOWN, Span
from .bands import FINE_WIDTH, Bands, match_bands
from .pairs import Pair

FIRST_WIDTH = 80
# Largest disparity of either sign, as a share of the picture's width, unless something stands still nearer.
REACH = 0.36
# The same for still nearer things, and the smallest share of matches beyond REACH that shows such a thing.
FAR_REACH, MIN_REVEALED = 0.8, 0.015
# Smallest range of the second copy, as a share of the width: it shows objects too thin for the first one.
THIN_REACH = 1 / 8
FRINGE = 0.0005  # share of the matches dropped at either end as errors
# Loss (share of speckles) from which the first copy, which averages noise away, counts as well.
NOISY = 0.6
FIRST_MARGIN, MARGIN = 1, 2
"""Margins added to the range of the first and second copy at either end, in pixels of the copy."""


class RangeEstimate(NamedTuple):
    """The range of a pair, and the bands that it was estimated in."""

    span: Span
    bands: Bands
    # True if every disparity is negative, which parallel cameras in the right order cannot produce.
    is_swapped: bool


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
    return RangeEstimate(wider, fine.bands, first.is_swapped and fine.is_swapped)


def _revealed_share(wide: Bands, near: Bands | None, reach: int) -> float:
    """Return the share of the matches that lie beyond `reach`, where the bands of a search within it have no match."""
    far_matches = (wide.disparity != UNKNOWN) & (np.abs(wide.disparity * (wide.factor / 16)) > reach)
    if near is not None:
        far_matches &= near.disparity == UNKNOWN
    return float(np.count_nonzero(far_matches) / max(1, wide.match_count))


def _range_of_bands(pair: Pair, span: Span, width: int, margin: int) -> RangeEstimate | None:
    bands = match_bands(pair, span.within(pair.width), width)
    factor = bands.factor
    if bands.match_count == 0:
        return None
    fringe = int(FRINGE * bands.match_count)
    ends = fringe, bands.match_count - 1 - fringe
    disparities = np.partition(bands.disparity[bands.disparity != UNKNOWN], ends)
    low, high = (disparities[[*ends]] * (factor / 16)).tolist()
    span = Span(floor(low) - margin * factor, ceil(high) + margin * factor)
    return RangeEstimate(span, bands, low < -2 and high <= 1)


log: logging.Logger = logging.getLogger(__name__)
Auto = Literal["auto"]
# Lowest share of the bands' matches in a step beyond verified ones that extends the range by that step.
MIN_BEYOND = 0.01
MIN_STEP_PX = 8
# Disparities up to which the range of a rectified pair is extended to all lanes: a larger one shrinks the pictures.
MAX_FILLED = 256

ALL_NEGATIVE = "every disparity is negative, as of exchanged views (left is right) and of pictures that were shifted"


class SearchRange(NamedTuple):
    """The disparities to try, and the bands that were matched to estimate them, None if they were given."""

    span: Span
    bands: Bands | None
    notes: tuple[tuple[str, int], ...] = ()  # messages about the estimate, each with its log level

    def log_notes(self) -> None:
        """Log the notes. Call it for the pair that is matched, not for one that turns out to need rectification."""
        for message, level in self.notes:
            note(log, message, level)


def find_disparity_range(
    pair: Pair, least: int | Auto, most: int | Auto, verified_px: tuple[int, int] | None = None
) -> SearchRange:
    """Return the range least..most - 1 px; auto: estimated in bands of the pair, or a least of 0 if most is given."""
    if most == "auto":
        return _estimate_range(pair, least, verified_px)
    low = 0 if least == "auto" else least
    if low >= most:
        raise PictureError(
            f"the search range {low}..{most - 1} px is empty; raise max_disparity_px or lower min_disparity_px"
        )
    return SearchRange(Span(low, most - 1).within(pair.width), None)


def _estimate_range(pair: Pair, least: int | Auto, verified_px: tuple[int, int] | None) -> SearchRange:
    estimate = find_range(pair)
    notes: list[tuple[str, int]] = []
    low, high = (0, reach_px(pair.width)) if estimate is None else estimate.span
    if estimate is not None and estimate.is_swapped:
        notes.append((ALL_NEGATIVE, logging.WARNING))
        high = min(high, 0)
    if verified_px is not None:
        # Some bands match by chance where a rectified picture is empty, so they widen the range only without a gap.
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
    if high > 0 and (verified_px is None or span.size <= MAX_FILLED):
        span = span.fill_lanes()
    return SearchRange(span.within(pair.width), estimate and estimate.bands, tuple(notes))


def _range_around_matches(span: Span, bands: Bands | None) -> Span:
    """Widen the range of verified matches at either end as far as the matches of the bands continue."""
    step = max(MIN_STEP_PX, span.size // 8)
    disparities = np.empty(0)
    if bands is not None:
        disparities = np.sort(bands.disparity[bands.disparity != UNKNOWN]) * (bands.factor / 16)
    return Span(-_extend_end(-span.low, -disparities[::-1], step), _extend_end(span.high, disparities, step))


def _extend_end(last: int, disparities: np.ndarray, step: int) -> int:
    """Extend `last` upwards while each step holds MIN_BEYOND of the sorted disparities; then add a step."""
    least = max(1, int(MIN_BEYOND * disparities.size))
    end = last
    while np.searchsorted(disparities, end + step) - np.searchsorted(disparities, end) >= least:
        end += step
    return end + max(step, MARGIN)
