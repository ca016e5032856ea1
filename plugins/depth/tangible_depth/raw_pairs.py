"""Raw pairs for methods that search along rows: what they match anyway tells whether rows correspond.

A rectified pair pays next to nothing. `estimate_raw` asks for the check and `check_rows` makes it where a method has
found or been told its range; between them stands the method, which knows of neither.
"""

import logging
from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Literal

import numpy as np

from tangible_core.data import DisparityMap, Views

from .bands import Bands, match_bands
from .corner_look import corners_correspond
from .notes import note
from .pairs import Pair
from .rectification import with_rectification
from .row_offset import LEAST_OFFSET_PX, LEAST_VOTES, realigned, row_votes
from .span import Span

Rectify = Literal["auto", "never"]

log = logging.getLogger(__name__)

LEAST_AGREED, MOST_SPREAD_PX = 0.45, 0.3
"""Share of the edges whose views agree on an offset, and median deviation of these offsets, if rows correspond. Damaged
pairs reach 0.21 px; a roll of 0.3 degrees has 0.47 px and more."""
_realigns: ContextVar[float | None] = ContextVar("tangible_depth_realigns", default=None)


class _RowsApart(Exception):
    """The rows of a pair do not correspond."""


def estimate_raw(
    views: Views, estimate: Callable[[Views], DisparityMap], mode: Rectify, realigns_px: float = 0.0
) -> DisparityMap:
    """Disparity of the left view by a method that searches along rows, rectified first where rows do not correspond.

    mode: `never` takes every pair as rectified; `auto` looks, unless the views carry a calibration (`check_rows`).
    realigns_px: the constant offset of rows that the method puts right by itself; 0: it is put right beforehand.
    Raises: CannotRectify as `rectify`; PictureError without a right view; and what `estimate` raises.
    """
    if mode == "never" or views.calibration is not None:
        return estimate(views)
    try:
        with _checked(realigns_px):
            return estimate(views)
    except _RowsApart:
        pass
    return with_rectification(views, estimate)


@contextmanager
def _checked(realigns_px: float) -> Generator[None]:
    token = _realigns.set(realigns_px)
    try:
        yield
    finally:
        _realigns.reset(token)


def check_rows(pair: Pair, span: Span, bands: Bands | None) -> Pair:
    """The pair, realigned if its rows miss each other by a constant; as it is unless `estimate_raw` asks for the check.

    Where the rows do not correspond otherwise, the method is left and `estimate_raw` rectifies.
    bands: what was matched to find the span, if it was found.
    """
    realigns_px = _realigns.get()
    if realigns_px is None:
        return pair
    common = common_offset(pair, bands or match_bands(pair, span))
    if common is None and not corners_correspond(pair, realigns_px):
        raise _RowsApart
    if common is None or realigns_px > 0 or abs(common) <= LEAST_OFFSET_PX:
        return pair
    note(log, f"rows realigned by {common:.2f} px")
    return realigned(pair, common)


def common_offset(pair: Pair, bands: Bands) -> float | None:
    """By how many pixels, 1.5 at most, the rows in the right view lie below those of the left one; None if they differ.

    Most horizontal edges that were matched must find their like, and half of these within MOST_SPREAD_PX.
    """
    votes = row_votes(pair, bands.rows, bands.disparity, bands.factor)
    agreed = votes[np.isfinite(votes)]
    if agreed.size < max(LEAST_VOTES, LEAST_AGREED * votes.size):
        return None
    common = float(np.median(agreed))
    return common if np.median(np.abs(agreed - common)) <= MOST_SPREAD_PX else None
