"""Whether the rows of a pair correspond, told by what is matched anyway: a rectified pair pays next to nothing."""

import logging

import numpy as np
from jaxtyping import Bool, Float32

from tangible_core.plugins.notes import note

from ..dense.span import UNKNOWN
from .bands import Bands
from .corner_look import corners_correspond
from .pairs import Pair
from .row_offset import CELL_PX, LEAST_ROW_OFFSET_PX, LEAST_VOTES, realigned, row_votes
from .row_profiles import rows_lie_elsewhere

log = logging.getLogger(__name__)

LEAST_AGREED, MOST_SPREAD_PX = 0.45, 0.3
"""Share of the edges whose views agree on an offset, and median deviation of these offsets, if rows correspond. Damaged
pairs reach 0.21 px; a roll of 0.3 degrees has 0.47 px and more."""
LEAST_AGREED_OF_MAP, MOST_OFF_PX = 0.3, 0.5
"""The share for a whole map, not averaged as bands are: noise of sd 10 leaves 0.32, a wall of bricks that is a course
lower 0.27. And by how much the rows may still miss each other."""


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
    return _agreed_px(row_votes(pair, bands.rows, bands.disparity, bands.factor), LEAST_AGREED)


def rows_correspond(pair: Pair, disparity_px: Float32[np.ndarray, "h w"], matched: Bool[np.ndarray, "h w"]) -> bool:
    """Whether what was `matched` finds its like in its own row: then it is noise that kept the rest from matching."""
    rows = np.arange(CELL_PX // 2, len(matched), CELL_PX)
    sixteenths = np.where(matched[rows], np.rint(16 * disparity_px[rows]), UNKNOWN).astype(np.int16)
    row_offset_px = _agreed_px(row_votes(pair, rows, sixteenths), LEAST_AGREED_OF_MAP)
    return row_offset_px is not None and abs(row_offset_px) <= MOST_OFF_PX


def _agreed_px(votes: Float32[np.ndarray, "votes"], least_agreed: float) -> float | None:
    """The median of `row_votes`; None if too few agree on one, or these differ."""
    agreed = votes[np.isfinite(votes)]
    if agreed.size < max(LEAST_VOTES, least_agreed * votes.size):
        return None
    row_offset_px = float(np.median(agreed))
    return row_offset_px if np.median(np.abs(agreed - row_offset_px)) <= MOST_SPREAD_PX else None
