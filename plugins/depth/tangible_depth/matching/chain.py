"""The steps that all dense matchers share: search range, rectification, exchanged views, and the map in pixels."""

import logging
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import note

from ..dense.confidence import zero_disparity
from ..dense.refinement import DenseMatches, to_disparity_map
from ..dense.span import Span
from ..rectify.rectification import rectify
from ..rectify.rectifying_rotation import RectificationError
from ..row_alignment.common_rows import align_rows, rows_correspond
from ..search.bands import match_bands
from ..search.disparity_range import Auto, find_disparity_range
from ..search.pairs import Pair, grey_pair

log: logging.Logger = logging.getLogger(__name__)

Matcher = Callable[[Pair, Span], DenseMatches]
"""A method that matches a pair along its rows over a range of disparities."""
Rectify = Literal["auto", "never"]
LOW_CONFIDENCE = 0.15
"""Confidence below which a pixel was filled, not matched."""
MAX_LOW_CONFIDENCE = 0.5
"""Share of pixels of low confidence above which the pair is tried again with rectification."""


class Search(NamedTuple):
    """The options of all dense matchers, and the steps that a matcher takes itself."""

    least: int | Auto
    most: int | Auto
    """Upper end of the search range, exclusive, pixels."""
    rectify: Rectify
    fill: bool
    most_row_offset_px: float = 0.0
    """Largest constant row offset that the matcher corrects itself, pixels."""
    skip_identical: bool = False


def disparity_map(views: Views, name: str, search: Search, match: Matcher) -> DisparityMap:
    """Compute the left view's disparity by a method that matches along rows. Raises: PictureError; as `rectify`."""
    pair = grey_pair(views, name)
    if search.skip_identical and np.array_equal(*pair):
        note(log, "skipped: matching, as both views are identical")
        return zero_disparity(pair.left, search.fill)
    estimate = find_disparity_range(pair, search.least, search.most)
    if search.rectify == "never" or views.calibration is not None:
        estimate.log_notes()
        return match_in_order(pair, estimate.span, search.fill, match)
    aligned_pair = align_rows(pair, estimate.bands or match_bands(pair, estimate.span), search.most_row_offset_px)
    if aligned_pair is None:
        return _match_rectified(views, name, search, match, None)
    estimate.log_notes()
    first = match_in_order(aligned_pair, estimate.span, search.fill, match)
    return first if _is_reliable(aligned_pair, first) else _retry_rectified(views, name, search, match, first)


def _match_rectified(
    views: Views, name: str, search: Search, match: Matcher, instead: DisparityMap | None
) -> DisparityMap:
    """Rectify a pair by features of the whole picture and match it; return `instead` if it needs no rectification."""
    rectified_pair = rectify(views, quick=False)
    if rectified_pair.skipped and instead is not None:
        return instead
    pair = grey_pair(rectified_pair.views, name)
    estimate = find_disparity_range(pair, search.least, search.most, rectified_pair.verified_px)
    estimate.log_notes()
    return rectified_pair.to_original(match_in_order(pair, estimate.span, search.fill, match))


def _is_reliable(pair: Pair, disparity: DisparityMap) -> bool:
    """Test whether most pixels were matched, or at least the matched ones show that the rows correspond."""
    if low_confidence_share(disparity) <= MAX_LOW_CONFIDENCE:
        return True
    correspond = rows_correspond(pair, disparity.disparity_px, disparity.confidence >= LOW_CONFIDENCE)
    if correspond:
        note(log, "skipped: another try with rectification, as rows correspond where the views match")
    return correspond


def _retry_rectified(views: Views, name: str, search: Search, match: Matcher, first: DisparityMap) -> DisparityMap:
    note(log, f"retried with rectification: {low_confidence_share(first):.0%} of the pixels have low confidence")
    try:
        again = _match_rectified(views, name, search, match, first)
    except RectificationError as error:
        note(log, f"matched without rectification: {error}", logging.WARNING)
        return first
    return again if low_confidence_share(again) < low_confidence_share(first) else first


def low_confidence_share(disparity: DisparityMap) -> float:
    """Return the share of pixels of low confidence, 0..1."""
    return float(np.count_nonzero(disparity.confidence < LOW_CONFIDENCE) / disparity.confidence.size)


def match_in_order(pair: Pair, span: Span, fill: bool, match: Matcher) -> DisparityMap:
    """Match the pair within `span`, in the right order of its views."""
    # Mirrored, exchanged views are a pair in the right order, with occlusions on the side where matchers expect them.
    is_exchanged = span.high <= 0 and pair.width > 1
    if is_exchanged:
        pair, span = pair.mirror(), Span(-span.high, -span.low)
    disparity = to_disparity_map(match(pair, span), pair.left, fill)
    if not is_exchanged:
        return disparity
    return DisparityMap(-disparity.disparity_px[:, ::-1], disparity.confidence[:, ::-1])
