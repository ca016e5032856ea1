"""Matches of what one homography does not explain: a small thing before a wall, which features of the whole miss."""

import numpy as np
from jaxtyping import Bool, Float32

from tangible_core.runtime.opencv import plain_opencv

from .harris import corners, harris_response, least_response
from .matches import Matches, corner_matches, inverse_lengths

WINDOW_PX = 7
"""Side of the windows that are matched: a small thing has room for no larger ones."""
MOST_CORNERS = 1000
"""How many corners of each picture are matched all against all."""
LEAST_ALIKE, LEAST_SCORE = 0.7, 0.85
"""Correlation from which two windows at the same place show the same, and from which two at any place match."""


def matches_off(left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], homography: np.ndarray) -> Matches:
    """Corners that are not where a homography (3, 3), from right to left, puts them, matched as `corner_matches` does.

    Right points are where the homography puts them.
    """
    import cv2

    size = left.shape[::-1]
    with plain_opencv():
        moved = cv2.warpPerspective(right, homography, size)
        shown = cv2.warpPerspective(np.ones_like(right), homography, size, flags=cv2.INTER_NEAREST) > 0
    off = shown & ~_alike(left, moved)
    seen = [
        corners(np.where(off, harris_response(grey), 0), least_response(0.005), MOST_CORNERS) for grey in (left, moved)
    ]
    return corner_matches(left, moved, seen[0], seen[1], WINDOW_PX, LEAST_SCORE)


def _alike(one: Float32[np.ndarray, "h w"], other: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Where windows of two pictures at the same place correlate."""
    import cv2

    side, half = (WINDOW_PX, WINDOW_PX), WINDOW_PX // 2
    with plain_opencv():
        mean, its, both = (
            cv2.boxFilter(each, cv2.CV_64F, side, borderType=cv2.BORDER_REPLICATE) for each in (one, other, one * other)
        )
    spread = (both - mean * its) * WINDOW_PX**2
    return spread * inverse_lengths(one, half) * inverse_lengths(other, half) >= LEAST_ALIKE
