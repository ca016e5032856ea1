"""The steps that all dense matchers share, for a pair and for the frames of a film, up to the map in pixels."""

import logging
from collections import deque
from collections.abc import Callable
from typing import Literal, NamedTuple, final

import numpy as np

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import note

from ..dense.confidence import zero_disparity
from ..dense.refinement import DenseMatches, to_disparity_map
from ..dense.span import Span
from ..rectify.projective import RectifiedPair
from ..rectify.rectification import rectify
from ..rectify.rectifying_rotation import RectificationError
from ..row_alignment.common_rows import align_rows, common_row_offset, rows_correspond, shift_rows
from ..search.bands import match_bands
from ..search.disparity_range import Auto, find_disparity_range
from ..search.pairs import Pair, grey_pair

log: logging.Logger = logging.getLogger(__name__)

Matcher = Callable[[Pair, Span], DenseMatches]
"""A method that matches a pair along its rows over a range of disparities."""
Rectify = Literal["auto", "never"]
LOW_CONFIDENCE = 0.15  # confidence below which a pixel was filled, not matched
# Share of pixels of low confidence above which the pair is tried again with rectification.
MAX_LOW_CONFIDENCE = 0.5


class Search(NamedTuple):
    """The options of all dense matchers, and the steps that a matcher takes itself."""

    least: int | Auto
    most: int | Auto  # upper end of the search range, exclusive, pixels
    rectify: Rectify
    fill: bool
    most_row_offset_px: float = 0.0  # largest constant row offset that the matcher corrects itself, pixels
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


# Frames after which the search range is estimated again, so that it follows objects that come nearer.
SEARCH_EVERY = 30
# Latest estimates of the range that count together, so that the range of a bad frame is dropped later.
SEARCHES = 8


@final
class FilmMatcher:
    """A `disparity_map` for the frames of a film: rectified by the first frame, with the range of recent frames."""

    def __init__(self, views: Views, name: str, search: Search, match: Matcher) -> None:
        """Prepare for frames like `views`. Raises: as `disparity_map`."""
        self._name, self._search, self._match = name, search, match
        self._rectified_pair: RectifiedPair | None = None
        self._row_offset_px = 0.0
        pair = grey_pair(views, name)
        estimate = find_disparity_range(pair, search.least, search.most)
        self._spans = deque([estimate.span], maxlen=SEARCHES)
        self._frames = 0
        if search.rectify == "never" or views.calibration is not None or np.array_equal(*pair):
            return
        bands = estimate.bands or match_bands(pair, estimate.span)
        aligned_pair = align_rows(pair, bands, search.most_row_offset_px)
        if aligned_pair is None:
            self._rectify(views)
        elif aligned_pair is not pair:
            self._row_offset_px = common_row_offset(pair, bands) or 0.0
        if aligned_pair is not None and low_confidence_share(first := self._match_frame(views)) > MAX_LOW_CONFIDENCE:
            self._rectify_if_better(views, low_confidence_share(first))

    def __call__(self, views: Views) -> DisparityMap:
        """Compute the disparity of the next frame's left view. Raises: PictureError without a right view."""
        disparity = self._match_frame(views)
        self._frames += 1
        return disparity

    def _match_frame(self, views: Views) -> DisparityMap:
        rectified_pair = None if self._rectified_pair is None else self._rectified_pair.warp(views)
        pair = grey_pair(views if rectified_pair is None else rectified_pair.views, self._name)
        if self._search.skip_identical and np.array_equal(*pair):
            return zero_disparity(pair.left, self._search.fill)
        if self._row_offset_px:
            pair = shift_rows(pair, self._row_offset_px)
        if self._frames % SEARCH_EVERY == SEARCH_EVERY - 1 and self._search.most == "auto":
            estimate = find_disparity_range(pair, self._search.least, "auto")
            if estimate.bands is not None:  # a frame without matches is ignored
                self._spans.append(estimate.span)
        disparity = match_in_order(pair, self._span.within(pair.width), self._search.fill, self._match)
        return disparity if rectified_pair is None else rectified_pair.to_original(disparity)

    @property
    def _span(self) -> Span:
        whole = Span(min(span.low for span in self._spans), max(span.high for span in self._spans))
        # A range that was given stays as it is.
        return whole.widen() if self._search.most == "auto" and whole.high > 0 else whole

    def _rectify(self, views: Views) -> None:
        rectified_pair = rectify(views, quick=False)
        if not rectified_pair.skipped:
            self._rectified_pair, self._row_offset_px = rectified_pair, 0.0
            pair = grey_pair(rectified_pair.views, self._name)
            self._spans = deque(
                [find_disparity_range(pair, self._search.least, self._search.most, rectified_pair.verified_px).span],
                maxlen=SEARCHES,
            )

    def _rectify_if_better(self, views: Views, before: float) -> None:
        """Rectify by the whole picture, and keep it if the map gets more confident, as `disparity_map` does."""
        range_before = self._spans, self._row_offset_px
        try:
            self._rectify(views)
        except RectificationError:
            return
        if self._rectified_pair is not None and low_confidence_share(self._match_frame(views)) >= before:
            self._rectified_pair, (self._spans, self._row_offset_px) = None, range_before
