"""Whether the rows of a pair correspond, told by what is matched anyway: a rectified pair pays next to nothing."""

import logging

import numpy as np
from jaxtyping import Bool, Float32

from tangible_core.plugins.notes import note
from tangible_core.runtime.opencv import plain_opencv

from ..dense.span import UNKNOWN
from ..search.bands import Bands
from ..search.pairs import Pair
from .corner_check import corners_correspond
from .profile_check import rows_lie_elsewhere
from .row_offset import CELL_PX, LEAST_ROW_OFFSET_PX, LEAST_VOTES, realigned, row_votes

log = logging.getLogger(__name__)

LEAST_AGREED, MOST_SPREAD_PX = 0.45, 0.3
"""Share of the edges whose views agree on an offset, and median deviation of these offsets, if rows correspond. Damaged
pairs reach 0.21 px; a roll of 0.3 degrees has 0.47 px and more."""
SMOOTHING_PX = 1.2
"""Sigma of the Gaussian that averages noise away before the rows of a whole map are judged; bands are averages."""
LEAST_AGREED_OF_MAP, MOST_SPREAD_OF_MAP_PX, MOST_OFF_PX = 0.5, 0.4, 0.5
"""The same two for a whole map, and by how much its rows may still miss each other. With noise of sd 5 to 15 two thirds
agree and spread by 0.18 to 0.43 px; of rows that lie two lower, which bands take for common, a quarter agree."""


def with_common_rows(pair: Pair, bands: Bands, most_row_offset_px: float) -> Pair | None:
    """The pair, realigned where its rows miss each other by a constant; None where they do not correspond otherwise.

    bands: what was matched of the pair. most_row_offset_px: the constant that the method puts right by itself; 0: it is
    put right here. Bands look along the rows only and are not believed alone: where the rows repeat, they match as well
    at a wrong height.
    """
    if rows_lie_elsewhere(pair):
        return None
    row_offset_px = common_row_offset(pair, bands)
    if row_offset_px is None:
        return pair if corners_correspond(pair, most_row_offset_px) else None
    if most_row_offset_px > 0 or abs(row_offset_px) <= LEAST_ROW_OFFSET_PX:
        return pair
    note(log, f"rows realigned by {row_offset_px:.2f} px")
    return realigned(pair, row_offset_px)


def common_row_offset(pair: Pair, bands: Bands) -> float | None:
    """By how many pixels, 1.5 at most, the rows in the right view lie below those of the left one; None if they differ.

    Most horizontal edges that were matched must find their like, and half of these within MOST_SPREAD_PX.
    """
    return _agreed_px(row_votes(pair, bands.rows, bands.disparity, bands.factor), LEAST_AGREED, MOST_SPREAD_PX)


def rows_correspond(pair: Pair, disparity_px: Float32[np.ndarray, "h w"], matched: Bool[np.ndarray, "h w"]) -> bool:
    """Whether what was `matched` finds its like in its own row: then it is noise that kept the rest from matching."""
    import cv2

    rows = np.arange(CELL_PX // 2, len(matched), CELL_PX)
    sixteenths = np.where(matched[rows], np.rint(16 * disparity_px[rows]), UNKNOWN).astype(np.int16)
    with plain_opencv():
        left, right = (cv2.GaussianBlur(each, (0, 0), SMOOTHING_PX) for each in pair)
    votes = row_votes(Pair(left, right), rows, sixteenths)  # pyright: ignore[reportArgumentType]
    row_offset_px = _agreed_px(votes, LEAST_AGREED_OF_MAP, MOST_SPREAD_OF_MAP_PX)
    return row_offset_px is not None and abs(row_offset_px) <= MOST_OFF_PX


def _agreed_px(votes: Float32[np.ndarray, "votes"], least_agreed: float, most_spread_px: float) -> float | None:
    """The median of `row_votes`; None if too few agree on one, or these differ."""
    agreed = votes[np.isfinite(votes)]
    if agreed.size < max(LEAST_VOTES, least_agreed * votes.size):
        return None
    row_offset_px = float(np.median(agreed))
    return row_offset_px if np.median(np.abs(agreed - row_offset_px)) <= most_spread_px else None
