"""The decision whether the rows of a pair correspond: the entry to this room.

`align_rows` takes three tests, in this order: row profiles (`profile_check`), edges of the bands that were matched for
the search range anyway (`row_offset`), and tracked corners (`corner_check`). A pair that fails is rectified
(`rectify.rectification`). A rectified pair pays next to nothing.
"""

import logging

import numpy as np
from jaxtyping import Bool, Float32

from tangible_core.plugins.notes import note
from tangible_core.runtime.opencv import plain_opencv

from ..dense.span import UNKNOWN
from ..search.bands import Bands
from ..search.pairs import Pair
from .corner_check import corners_correspond
from .profile_check import rows_match_elsewhere
from .row_offset import CELL_PX, LEAST_ROW_OFFSET_PX, LEAST_VOTES, row_votes, shift_rows

log: logging.Logger = logging.getLogger(__name__)

LEAST_AGREED = 0.45
"""Lowest share of the edges with a row offset in a pair whose rows correspond."""
MOST_SPREAD_PX = 0.3
"""Largest median deviation of these offsets, in pixels. Damaged pairs reach 0.21; a roll of 0.3 degrees has 0.47."""
SMOOTHING_PX = 1.2
"""Sigma of the Gaussian that averages noise away before a whole map is tested; bands are averages already."""
LEAST_AGREED_OF_MAP, MOST_SPREAD_OF_MAP_PX = 0.5, 0.4
"""LEAST_AGREED and MOST_SPREAD_PX for a whole map. With noise of sd 5 to 15 two thirds agree, with a deviation of 0.18
to 0.43 px; of rows that lie two lower, which bands take for common, a quarter agree."""
MOST_OFF_PX = 0.5
"""Largest row offset of a whole map whose rows correspond, in pixels."""


def align_rows(pair: Pair, bands: Bands, most_row_offset_px: float) -> Pair | None:
    """Return the pair, its right view shifted by a constant row offset; None if its rows do not correspond.

    bands: the matches in bands of the pair. most_row_offset_px: largest offset that the method corrects itself; if 0,
    it is corrected here. Bands compare along the rows only and are not trusted alone: repetitive rows match at a wrong
    height too.
    """
    if rows_match_elsewhere(pair):
        return None
    row_offset_px = common_row_offset(pair, bands)
    if row_offset_px is None:
        return pair if corners_correspond(pair, most_row_offset_px) else None
    if most_row_offset_px > 0 or abs(row_offset_px) <= LEAST_ROW_OFFSET_PX:
        return pair
    note(log, f"rows realigned by {row_offset_px:.2f} px")
    return shift_rows(pair, row_offset_px)


def common_row_offset(pair: Pair, bands: Bands) -> float | None:
    """Measure by how many pixels the right rows lie below the left ones, 1.5 at most; None if it varies.

    LEAST_AGREED of the matched horizontal edges must have an offset, half of these within MOST_SPREAD_PX.
    """
    return _agreed_offset_px(row_votes(pair, bands.rows, bands.disparity, bands.factor), LEAST_AGREED, MOST_SPREAD_PX)


def rows_correspond(pair: Pair, disparity_px: Float32[np.ndarray, "h w"], matched: Bool[np.ndarray, "h w"]) -> bool:
    """Test whether `matched` pixels of a map correlate best in their own row: then noise prevented other matches."""
    import cv2

    rows = np.arange(CELL_PX // 2, len(matched), CELL_PX)
    sixteenths = np.where(matched[rows], np.rint(16 * disparity_px[rows]), UNKNOWN).astype(np.int16)
    with plain_opencv():
        left, right = (cv2.GaussianBlur(each, (0, 0), SMOOTHING_PX) for each in pair)
    votes = row_votes(Pair.of(left, right), rows, sixteenths)
    row_offset_px = _agreed_offset_px(votes, LEAST_AGREED_OF_MAP, MOST_SPREAD_OF_MAP_PX)
    return row_offset_px is not None and abs(row_offset_px) <= MOST_OFF_PX


def _agreed_offset_px(votes: Float32[np.ndarray, "votes"], least_agreed: float, most_spread_px: float) -> float | None:
    """Return the median of `row_votes`; None if there are too few, or their deviation is too large."""
    agreed = votes[np.isfinite(votes)]
    if agreed.size < max(LEAST_VOTES, least_agreed * votes.size):
        return None
    row_offset_px = float(np.median(agreed))
    return row_offset_px if np.median(np.abs(agreed - row_offset_px)) <= most_spread_px else None
