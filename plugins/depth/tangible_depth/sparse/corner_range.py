"""The search range of a pair, from its matched corners."""

from math import ceil, floor
from typing import Literal

import numpy as np
from jaxtyping import Float32, Float64

from ..dense.span import Span
from .harris import corners, harris_response, least_response
from .matches import corner_matches

MAX_CORNERS = 2000
FEWEST = 20

MaxDisparity = int | Literal["auto"]


def range_of_shifts(shift_px: Float64[np.ndarray, "n 2"], width: int) -> Span:
    """Return the lowest and highest disparity of shifts (x, y), left - right, of rectified matches."""
    on_row = np.abs(shift_px[:, 1]) <= 2
    if np.count_nonzero(on_row) < FEWEST:
        return Span(0, ceil(width / 4)).within(width)
    # Zero is always included, as a far wall without detail has no corners.
    low, high = np.percentile(shift_px[on_row, 0], [1, 99])
    margin = max(4.0, 0.1 * (high - low))
    return Span(floor(min(0.0, low - margin)), ceil(high + margin)).within(width)


def range_of_pair(left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], most: MaxDisparity) -> Span:
    """Return the lowest and highest disparity of a rectified pair: 0 to `most`, or auto: by its corners."""
    if most != "auto":
        return Span(0, most).within(left.shape[1])
    corner_points = [corners(harris_response(grey), least_response(0.005), MAX_CORNERS) for grey in (left, right)]
    matches = corner_matches(left, right, corner_points[0], corner_points[1])
    return range_of_shifts(matches.left_px - matches.right_px, left.shape[1])
