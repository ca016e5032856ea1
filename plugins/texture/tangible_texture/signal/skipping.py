"""Reasons to leave a picture undivided."""

from typing import Literal

import numpy as np

from tangible_core.data import SegmentMap
from tangible_core.data.pictures import is_one_colour


def reason_to_skip(picture: np.ndarray, segments: int | Literal["auto"]) -> str | None:
    """Return a reason in words why the picture is one segment; None if it must be segmented to know."""
    if segments == 1:
        return "one segment is requested; `segments: auto` or a larger number divides the picture"
    return "the picture is one flat colour" if is_one_colour(picture) else None


def one_segment(shape: tuple[int, int]) -> SegmentMap:
    """Return one segment that covers a picture of (h, w) pixels."""
    return SegmentMap(np.zeros(shape, np.int32))
