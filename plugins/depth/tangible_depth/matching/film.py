"""Matching of the frames of a film: rectification is estimated from the first frame and reused."""

from collections import deque
from typing import final

import numpy as np

from tangible_core.data import DisparityMap, Views

from ..dense.confidence import zero_disparity
from ..dense.span import Span
from ..rectify.rectification import rectify
from ..rectify.rectified_pair import RectifiedPair
from ..rectify.rectifying_rotation import RectificationError
from ..row_alignment.common_rows import align_rows, common_row_offset, shift_rows
from ..search.bands import match_bands
from ..search.disparity_range import find_disparity_range
from ..search.pairs import grey_pair
from .chain import MAX_LOW_CONFIDENCE, Matcher, Search, low_confidence_share, match_in_order

SEARCH_EVERY = 30
"""Frames after which the search range is estimated again, so that it follows objects that come nearer."""
SEARCHES = 8
"""Latest estimates of the range that count together, so that the range of a bad frame is dropped later."""


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
