"""Depth edges moved to where the picture has its edges.

Windows and paths let a near surface grow over its neighbour by a pixel or two. Round every depth edge the two surfaces
are put to the vote: the pixels of a small window, weighted by how much their grey value is like the pixel's own, decide
which of the two it belongs to. This is the weighted median of Ma et al., Constant time weighted median filtering for
stereo matching and beyond, ICCV 2013, cut down to two candidates and to the pixels where there is a choice.
"""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

import numpy as np
from jaxtyping import Int16, UInt8
from numba import int16, int32, njit

MEDIAN_REACH = 2
"""Rows and columns round a pixel of which `median` is."""
NEARBY, VOTERS, STRIDE = 1, 4, 2
"""Radius in which an edge is looked for; radius of the voting window, and distance of its voters, in pixels."""
JUMP = 24
"""Sixteenths of a pixel that make an edge."""
GREY_REACH = np.int16(24)
"""Grey levels at which a vote has lost all its weight."""


def median(disparity: Int16[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """5 x 5 median; beyond the picture its edge is repeated."""
    import cv2

    return cv2.medianBlur(disparity, 2 * MEDIAN_REACH + 1)  # pyright: ignore[reportReturnType]


def sharpen_edges(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """A dense map in sixteenths of a pixel, each pixel near a depth edge on the side that its grey value votes for.

    A pixel that changes sides takes the weighted mean of its new side.
    """
    import cv2

    window = np.ones((2 * NEARBY + 1, 2 * NEARBY + 1), np.uint8)
    out = disparity.copy()
    _vote(disparity, grey, cv2.erode(disparity, window), cv2.dilate(disparity, window), out)
    return out


@njit(nogil=True, boundscheck=False, cache=True)
def _vote(disparity, grey, far, near, out):
    h, w = disparity.shape
    for y in range(h):
        for x in range(w):
            lowest, highest = int32(far[y, x]), int32(near[y, x])
            if highest - lowest >= JUMP:
                middle = np.int16((lowest + highest) >> 1)
                front = _majority(disparity, grey, y, x, middle)
                if (disparity[y, x] > middle) != (front > 0) and front != 0:
                    out[y, x] = _mean_of_side(disparity, grey, y, x, middle, front > 0)


@njit(nogil=True, boundscheck=False)
def _majority(disparity, grey, y, x, middle):
    """Votes for the front less votes for the back."""
    h, w = disparity.shape
    own = int16(grey[y, x])
    votes = int32(0)
    for v in range(y - VOTERS, y + VOTERS + 1, STRIDE):
        for u in range(x - VOTERS, x + VOTERS + 1, STRIDE):
            if not (0 <= v < h and 0 <= u < w):
                continue
            weight = max(GREY_REACH - abs(int16(grey[v, u]) - own), int16(0))
            votes += weight if disparity[v, u] > middle else -weight
    return votes


@njit(nogil=True, boundscheck=False)
def _mean_of_side(disparity, grey, y, x, middle, front):
    h, w = disparity.shape
    own = int32(grey[y, x])
    weights = total = int32(0)
    for v in range(y - VOTERS, y + VOTERS + 1, STRIDE):
        for u in range(x - VOTERS, x + VOTERS + 1, STRIDE):
            if not (0 <= v < h and 0 <= u < w):
                continue
            if (disparity[v, u] > middle) == front:
                weight = max(int32(GREY_REACH) - abs(int32(grey[v, u]) - own), int32(0))
                weights += weight
                total += weight * disparity[v, u]
    return np.int16(total // weights)
