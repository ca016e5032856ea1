"""The frames of a film matched one after the other: what the first one shows of the cameras is kept."""

from collections import deque
from typing import final

import numpy as np

from tangible_core.data import DisparityMap, Views

from ..dense.span import Span
from ..rectify.rectification import rectify, whole_picture_matches
from ..rectify.rectified_pair import RectifiedPair
from ..rectify.rectifying_rotation import RectificationError
from ..row_alignment.common_rows import common_row_offset, with_common_rows
from ..row_alignment.row_offset import realigned
from ..search.bands import match_bands
from ..search.disparity_range import asked_span
from ..search.pairs import Pair, grey_pair
from .chain import MOST_DOUBTFUL, Matcher, Search, doubtful, in_order, nothing_moved

LOOK_EVERY, LOOKS = 30, 8
"""Frames after which the range is looked for again, and how many of these looks count: what comes nearer is let in, and
what one bad frame shows is forgotten."""


@final
class FollowedPair:
    """`chain.disparity_map` for the frames of a film: the rectification is found once, and the range now and then.

    The range covers what was found in the last LOOKS looks.
    """

    def __init__(self, views: Views, name: str, search: Search, match: Matcher) -> None:
        """Raises: as `disparity_map`."""
        self._name, self._search, self._match = name, search, match
        self._turned: RectifiedPair | None = None
        self._row_offset_px = 0.0
        pair = grey_pair(views, name)
        found = asked_span(pair, search.least, search.most)
        self._spans = deque([found.span], maxlen=LOOKS)
        self._frames = 0
        if search.rectify == "never" or views.calibration is not None or np.array_equal(*pair):
            return
        bands = found.bands or match_bands(pair, found.span)
        aligned = with_common_rows(pair, bands, search.most_row_offset_px)
        if aligned is None:
            self._turn(views)
        elif aligned is not pair:
            self._row_offset_px = common_row_offset(pair, bands) or 0.0
        if aligned is not None and doubtful(first := self._matched(views)) > MOST_DOUBTFUL:
            self._turn_if_better(views, doubtful(first))

    def __call__(self, views: Views) -> DisparityMap:
        """Disparity of the left view of the next frame. Raises: PictureError without a right view."""
        found = self._matched(views)
        self._frames += 1
        return found

    def _matched(self, views: Views) -> DisparityMap:
        turned = None if self._turned is None else self._turned.again(views)
        pair = grey_pair(views if turned is None else turned.views, self._name)
        if self._search.skip_identical and np.array_equal(*pair):
            return nothing_moved(pair, self._search.fill)
        if self._row_offset_px:
            pair = realigned(pair, self._row_offset_px)
        if self._frames % LOOK_EVERY == LOOK_EVERY - 1:
            self._look(pair)
        found = in_order(pair, self._span.within(pair.width), self._search.fill, self._match)
        return found if turned is None else turned.to_original(found)

    @property
    def _span(self) -> Span:
        whole = Span(min(each.low for each in self._spans), max(each.high for each in self._spans))
        # Of a range that was told nothing changes.
        return whole.roomy() if self._search.most == "auto" and whole.high > 0 else whole

    def _look(self, pair: Pair) -> None:
        """For a range that was not told: of a frame in which nothing matches, nothing is learnt."""
        if self._search.most != "auto":
            return
        found = asked_span(pair, self._search.least, self._search.most)
        if found.bands is not None:
            self._spans.append(found.span)

    def _turn(self, views: Views) -> None:
        turned = rectify(views, matches=whole_picture_matches(views))
        if not turned.skipped:
            self._turned, self._row_offset_px = turned, 0.0
            pair = grey_pair(turned.views, self._name)
            self._spans = deque(
                [asked_span(pair, self._search.least, self._search.most, turned.seen_px).span], maxlen=LOOKS
            )

    def _turn_if_better(self, views: Views, before: float) -> None:
        """By the whole picture, as a single pair that fares as badly is."""
        kept = self._spans, self._row_offset_px
        try:
            self._turn(views)
        except RectificationError:
            return
        if self._turned is not None and doubtful(self._matched(views)) >= before:
            self._turned, (self._spans, self._row_offset_px) = None, kept
