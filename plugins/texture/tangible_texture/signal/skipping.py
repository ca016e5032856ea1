"""Reasons to leave a picture undivided."""

from typing import Literal

import numpy as np

from tangible_core.data import SegmentMap, Views, is_one_colour
from tangible_core.plugins import Segmenter, Skippable


class Dividing(Segmenter, Skippable):
    """A method with an option `segments`; one segment needs no method."""

    segments: int | Literal["auto"] = "auto"
    """Number of segments."""

    def skip(self, views: Views) -> str | None:
        """Return a reason to make one segment: one flat colour, or one segment requested; None otherwise."""
        if self.segments == 1:
            return "one segment is requested; `segments: auto` or a larger number divides the picture"
        return "the picture is one flat colour" if is_one_colour(views.left) else None


def one_segment(shape: tuple[int, int]) -> SegmentMap:
    """Return one segment that covers a picture of (h, w) pixels."""
    return SegmentMap(np.zeros(shape, np.int32))
