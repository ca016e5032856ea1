"""Which disparities a scene shows, by its matched corners: what cannot occur need not be searched."""

from typing import Literal

import numpy as np
from jaxtyping import Float32, Float64

from .harris import corners, harris_response, least_response
from .matches import corner_matches

MOST_CORNERS = 2000
"""How many corners of each picture are matched all against all."""
FEWEST = 20
"""Matches below which they tell nothing."""

MaxDisparity = int | Literal["auto"]


def range_of_shifts(shift_px: Float64[np.ndarray, "n 2"], width: int) -> tuple[int, int]:
    """Lowest and highest disparity, both included, from the shifts (x, y), left minus right, of rectified matches.

    Those off their rows are left out, the rest gets a tenth of its range to spare. Zero is always within: a far wall
    without detail has no corner to speak for it. Where hardly any match is on its row: 0 to a quarter of the width.
    """
    on_row = np.abs(shift_px[:, 1]) <= 2
    if np.count_nonzero(on_row) < FEWEST:
        return within(0, width / 4, width)
    low, high = np.percentile(shift_px[on_row, 0], [1, 99])
    margin = max(4.0, 0.1 * (high - low))
    return within(min(0.0, low - margin), high + margin, width)


def within(low: float, high: float, width: int) -> tuple[int, int]:
    """Whole disparities that a picture of this width can show."""
    first = int(np.clip(np.floor(low), 1 - width, width - 1))
    return first, int(np.clip(np.ceil(high), first, width - 1))


def range_of_pair(
    left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], most: MaxDisparity
) -> tuple[int, int]:
    """Lowest and highest disparity of a rectified pair: 0 to `most`, or what its corners show."""
    if most != "auto":
        return within(0, most, left.shape[1])
    seen = [corners(harris_response(grey), least_response(0.005), MOST_CORNERS) for grey in (left, right)]
    matches = corner_matches(left, right, seen[0], seen[1])
    return range_of_shifts(matches.left_px - matches.right_px, left.shape[1])
