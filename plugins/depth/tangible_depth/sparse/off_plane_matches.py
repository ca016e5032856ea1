"""Matches off a dominant plane: a small object before a wall, which features of the whole picture miss."""

import numpy as np
from jaxtyping import Bool, Float32

from tangible_core.runtime.opencv import plain_opencv

from .harris import corners, harris_response, least_response
from .matches import Matches, corner_matches, inverse_lengths

WINDOW_PX = 7
"""Side of the matched windows, in pixels, small enough for small objects."""
MOST_CORNERS = 1000
"""Largest number of corners of each picture that are matched all against all."""
LEAST_ALIKE = 0.7
"""Lowest correlation of windows at the same place that lie on the plane."""
LEAST_SCORE = 0.85
"""Lowest correlation of a match."""


def match_off_plane(
    left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], homography: np.ndarray
) -> Matches:
    """Match corners that a homography (3, 3), from right to left, does not explain, as `corner_matches` does.

    Right points are returned in the left picture's frame, mapped by the homography.
    """
    import cv2

    size = left.shape[::-1]
    with plain_opencv():
        moved = cv2.warpPerspective(right, homography, size)
        shown = cv2.warpPerspective(np.ones_like(right), homography, size, flags=cv2.INTER_NEAREST) > 0
    off = shown & ~_correlating(left, moved)
    seen = [
        corners(np.where(off, harris_response(grey), 0), least_response(0.005), MOST_CORNERS) for grey in (left, moved)
    ]
    return corner_matches(left, moved, seen[0], seen[1], WINDOW_PX, LEAST_SCORE)


def _correlating(one: Float32[np.ndarray, "h w"], other: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Find the pixels at which windows of two pictures at the same place correlate."""
    import cv2

    side, half = (WINDOW_PX, WINDOW_PX), WINDOW_PX // 2
    with plain_opencv():
        mean, its, both = (
            cv2.boxFilter(each, cv2.CV_64F, side, borderType=cv2.BORDER_REPLICATE) for each in (one, other, one * other)
        )
    spread = (both - mean * its) * WINDOW_PX**2
    return spread * inverse_lengths(one, half) * inverse_lengths(other, half) >= LEAST_ALIKE
