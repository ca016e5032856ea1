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

from tangible_core.threads import in_blocks

NEARBY, VOTERS, STRIDE = 1, 4, 2
"""Radius in which an edge is looked for; radius of the voting window, and distance of its voters, in pixels."""
JUMP = 24
"""Sixteenths of a pixel that make an edge."""
GREY_REACH = np.int16(24)
"""Grey levels at which a vote has lost all its weight."""


def median(disparity: Int16[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """5 x 5 median."""
    import cv2

    out = np.empty_like(disparity)
    h = disparity.shape[0]

    def block(y0: int, y1: int) -> None:
        low, high = max(0, y0 - 2), min(h, y1 + 2)
        out[y0:y1] = cv2.medianBlur(np.ascontiguousarray(disparity[low:high]), 5)[y0 - low : y1 - low]

    in_blocks(h, block)
    return out


def sharpen_edges(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """A dense map in sixteenths of a pixel, each pixel near a depth edge on the side that its grey value votes for.

    A pixel that changes sides takes the weighted mean of its new side.
    """
    import cv2

    window = np.ones((2 * NEARBY + 1, 2 * NEARBY + 1), np.uint8)
    out = disparity.copy()
    h = disparity.shape[0]

    def block(y0: int, y1: int) -> None:
        low, high = max(0, y0 - NEARBY), min(h, y1 + NEARBY)
        part = np.ascontiguousarray(disparity[low:high])
        far, near = (change(part, window)[y0 - low : y1 - low] for change in (cv2.erode, cv2.dilate))
        _vote(disparity, grey, far, near, y0, y1, out)

    in_blocks(h, block)
    return out


@njit(nogil=True, boundscheck=False, cache=True)
def _vote(disparity, grey, far, near, y0, y1, out):
    w = disparity.shape[1]
    for y in range(y0, y1):
        for x in range(w):
            lowest, highest = int32(far[y - y0, x]), int32(near[y - y0, x])
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
