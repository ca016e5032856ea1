"""From a pair to a disparity map: what is skipped, at which size is matched, and what follows."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np
from tangible_core.data import DisparityMap, Views
from tangible_core.errors import PictureError

from .adaptive import match
from .costs import COSTS
from .confidence import flat_pixels
from .dense import Dense, as_map, completed, enlarged
from .notes import note
from .pairs import Pair, grey_pair
from .search_range import find_range
from .strips import MOST_LANES, strips
from .sweep import Span

if TYPE_CHECKING:
    from .semi_global import SemiGlobal

log = logging.getLogger(__name__)
TOLERANCE = {"soft": 1.08, "strict": 1.0}
WIDEST_AT_FULL_SIZE = 256
"""Disparities up to which `auto` works at full size: beyond, a coarser map costs little and saves much."""


def estimate(views: Views, options: SemiGlobal) -> DisparityMap:
    """What `SemiGlobal.estimate` says."""
    pair = grey_pair(views, "semi-global")
    if options.skip_identical and np.array_equal(*pair):
        note(log, "skipped: matching, as both views are identical")
        return _nothing_moved(pair, options.fill)
    span = _given(options, pair.width) or _found(pair, options)
    if span.high > 0:
        return _match(pair, span, options)
    mirrored = _match(pair.mirrored(), Span(-span.high, -span.low), options)
    return DisparityMap(-mirrored.disparity_px[:, ::-1], mirrored.confidence[:, ::-1])


def _nothing_moved(pair: Pair, fill: bool) -> DisparityMap:
    flat = flat_pixels(pair.left)
    known = np.where(flat, np.float32(np.nan), np.float32(0))
    return DisparityMap(known if flat.all() or not fill else np.zeros_like(known), (~flat).astype(np.float32))


def _given(options: SemiGlobal, width: int) -> Span | None:
    """The disparities asked for; None if they are to be found.

    Raises: PictureError if there are none.
    """
    if options.max_disparity_px == "auto":
        return None
    low = 0 if options.min_disparity_px == "auto" else options.min_disparity_px
    if low >= options.max_disparity_px:
        raise PictureError(f"no disparity is in {low}..{options.max_disparity_px - 1} px; raise max_disparity_px")
    return Span(low, options.max_disparity_px - 1).within(width)


def _found(pair: Pair, options: SemiGlobal) -> Span:
    found = find_range(pair)
    if found is None:
        return Span(0, 15).within(pair.width)
    low, high = found.span
    if found.swapped:
        note(log, "every disparity is negative: the views seem to be exchanged (left is right)", logging.WARNING)
        high = min(high, 0)
    if options.min_disparity_px != "auto":
        low, high = options.min_disparity_px, max(high, options.min_disparity_px)
    note(log, f"skipped: disparities outside {low}..{high} px, which do not occur")
    return Span(low, high).within(pair.width)


def _match(pair: Pair, span: Span, options: SemiGlobal) -> DisparityMap:
    factor = _factor(span, options)
    small = pair.shrunk(factor)
    dense = _match_at_full_size(small, span.shrunk(factor).within(small.width), options)
    while factor > 1:
        factor //= 2
        dense = enlarged(dense, pair.shrunk(factor).left)
    return as_map(dense, pair.left, options.fill)


def _factor(span: Span, options: SemiGlobal) -> int:
    """By how much the pictures are made smaller before they are matched: a power of two."""
    factor = 2 if options.resolution == "half" else 1
    most = WIDEST_AT_FULL_SIZE if options.resolution == "auto" else MOST_LANES
    while span.shrunk(factor).count > most:
        factor *= 2
    if factor > 1:
        note(log, f"skipped: full resolution, matched at 1/{factor}")
    return factor


def _match_at_full_size(pair: Pair, span: Span, options: SemiGlobal) -> Dense:
    rows = strips(pair.left.shape, span)
    flat = flat_pixels(pair.left)
    if options.skip_flat:
        textured = [(a, b) for a, b in rows if not flat[a:b].all()]
        if len(textured) < len(rows):
            note(log, f"skipped: {len(rows) - len(textured)} of {len(rows)} strips, which have no texture")
        rows = textured
    swept, cost = match(pair, span, COSTS.get(options.cost), TOLERANCE[options.check], options.realign_rows, rows)
    return completed(swept.disparity, swept.sums, 4 * cost.bits, pair.left)
