"""When a picture need not be divided at all."""

from typing import Literal

import numpy as np

from tangible_core.data import SegmentMap
from tangible_core.data.pictures import is_one_colour


def reason_to_skip(picture: np.ndarray, segments: int | Literal["auto"]) -> str | None:
    """Why a picture is one segment whatever it shows, in words; None if that is not known beforehand."""
    if segments == 1:
        return "one segment is asked for; `segments: auto` or a larger number divides the picture"
    return "the picture is one flat colour" if is_one_colour(picture) else None


def one_segment(shape: tuple[int, int]) -> SegmentMap:
    """All of a picture of (h, w) pixels."""
    return SegmentMap(np.zeros(shape, np.int32))
