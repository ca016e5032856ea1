"""What all dense matchers do round their matching: the range, raw pairs, exchanged views, and the map in pixels."""

import logging
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins.notes import note

from ..dense.confidence import flat_pixels
from ..dense.refinement import DenseMatches, as_map
from ..dense.span import Span
from ..rectify.rectification import rectify, whole_picture_matches
from ..rectify.rectifying_rotation import RectificationError
from ..row_alignment.common_rows import rows_correspond, with_common_rows
from ..search.bands import match_bands
from ..search.disparity_range import Auto, asked_span
from ..search.pairs import Pair, grey_pair

log = logging.getLogger(__name__)

Matcher = Callable[[Pair, Span], DenseMatches]
Rectify = Literal["auto", "never"]
DOUBTFUL, MOST_DOUBTFUL = 0.15, 0.5
"""Confidence below which a pixel was not matched but filled; and the share of such pixels from which a map fares so
badly that the whole picture is looked at again."""


class Search(NamedTuple):
    """The options that all dense matchers have, and what a matcher does by itself."""

    least: int | Auto
    most: int | Auto
    rectify: Rectify
    fill: bool
    most_row_offset_px: float = 0.0
    """The constant offset of rows that the matcher puts right."""
    skip_identical: bool = False


def disparity_map(views: Views, name: str, search: Search, match: Matcher) -> DisparityMap:
    """Disparity of the left view by the method `name`, which matches along rows.

    A pair whose rows do not correspond is rectified first, unless its calibration says that it is or `rectify` is
    `never`. Raises: PictureError without a right view or for an empty range; RectificationError as `rectify`.
    """
    pair = grey_pair(views, name)
    if search.skip_identical and np.array_equal(*pair):
        note(log, "skipped: matching, as both views are identical")
        return nothing_moved(pair, search.fill)
    found = asked_span(pair, search.least, search.most)
    if search.rectify == "never" or views.calibration is not None:
        found.say()
        return in_order(pair, found.span, search.fill, match)
    aligned = with_common_rows(pair, found.bands or match_bands(pair, found.span), search.most_row_offset_px)
    if aligned is None:
        return _rectified(views, name, search, match, None)
    found.say()
    first = in_order(aligned, found.span, search.fill, match)
    return first if _fares_well(aligned, first) else _looked_over(views, name, search, match, first)


def _rectified(views: Views, name: str, search: Search, match: Matcher, instead: DisparityMap | None) -> DisparityMap:
    """The map of a pair that is turned by features of the whole picture; `instead` of one that need not be."""
    rectified = rectify(views, matches=whole_picture_matches(views))
    if rectified.skipped and instead is not None:
        return instead
    pair = grey_pair(rectified.views, name)
    found = asked_span(pair, search.least, search.most, rectified.seen_px)
    found.say()
    return rectified.to_original(in_order(pair, found.span, search.fill, match))


def _fares_well(pair: Pair, found: DisparityMap) -> bool:
    """Whether most was matched, or what was matched shows at least that the rows correspond."""
    if doubtful(found) <= MOST_DOUBTFUL:
        return True
    correspond = rows_correspond(pair, found.disparity_px, found.confidence >= DOUBTFUL)
    if correspond:
        note(log, "skipped: a look at the whole picture, as rows correspond where the views match")
    return correspond


def _looked_over(views: Views, name: str, search: Search, match: Matcher, first: DisparityMap) -> DisparityMap:
    """The map that was found, or a better one by a look at the whole picture."""
    note(log, f"looked again at the whole picture: {doubtful(first):.0%} of the map are hardly trusted")
    try:
        again = _rectified(views, name, search, match, first)
    except RectificationError as error:
        note(log, f"matched as it is: {error}", logging.WARNING)
        return first
    return again if doubtful(again) < doubtful(first) else first


def doubtful(found: DisparityMap) -> float:
    """Share of the pixels whose disparity is hardly trusted."""
    return float(np.count_nonzero(found.confidence < DOUBTFUL) / found.confidence.size)


def in_order(pair: Pair, span: Span, fill: bool, match: Matcher) -> DisparityMap:
    """The pair matched within `span`.

    Where this is negative throughout, the views are exchanged: mirrored they are a pair in the right order, in which
    what is hidden lies on the side where the matchers expect it.
    """
    if span.high > 0 or pair.width == 1:
        return as_map(match(pair, span), pair.left, fill)
    flipped = pair.mirrored()
    found = as_map(match(flipped, Span(-span.high, -span.low)), flipped.left, fill)
    return DisparityMap(-found.disparity_px[:, ::-1], found.confidence[:, ::-1])


def nothing_moved(pair: Pair, fill: bool) -> DisparityMap:
    """The map of two identical views: 0 everywhere, and nothing known where nothing changes along the rows."""
    flat = flat_pixels(pair.left)
    unknown = flat & (not fill or bool(flat.all()))
    return DisparityMap(np.where(unknown, np.float32(np.nan), np.float32(0)), (~flat).astype(np.float32))
