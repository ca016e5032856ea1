"""Depth edges aligned with the edges of the picture, by a weighted median of two candidates (Ma et al., ICCV 2013)."""

import cv2
import numpy as np
from jaxtyping import Int16, UInt8
from numba import int32, uint16

from tangible_core.compiled import KERNEL, inner, njit

from ..simd.lane_reductions import total
from ..simd.lanes import Lanes, add, load, maximum, minimum, multiply, splat, subtract

MEDIAN_REACH = 2
NEARBY = 1
VOTERS = 4
STRIDE = 2
JUMP = 24  # smallest depth step of an edge, in sixteenths of a pixel
GREY_REACH = 24  # grey difference, in levels, at which a vote has no weight left
# SIMD lanes for a row of the voting window, at least as many as it has pixels.
LANES = 16
VOTING = np.array([k <= 2 * VOTERS and k % STRIDE == 0 for k in range(LANES)], np.uint16)
ZERO_RANK = np.uint16(32768)  # offset that makes disparities unsigned and keeps their order
# Grey level of pixels beyond the picture: too far from any real one to have a vote.
NO_GREY = 1000


def median(disparity: Int16[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """Filter with a 5 x 5 median; the picture's edge is repeated outwards."""
    return cv2.medianBlur(disparity, 2 * MEDIAN_REACH + 1)  # pyright: ignore[reportReturnType]


def sharpen_edges(disparity: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """Move each pixel near a depth edge to the surface that its grey value votes for."""
    window = np.ones((2 * NEARBY + 1, 2 * NEARBY + 1), np.uint8)
    out = disparity.copy()
    around = VOTERS, VOTERS, VOTERS, LANES
    ranks = cv2.copyMakeBorder(disparity.view(np.uint16) + ZERO_RANK, *around, cv2.BORDER_REPLICATE)
    greys = cv2.copyMakeBorder(grey.astype(np.uint16), *around, cv2.BORDER_CONSTANT, value=NO_GREY)
    far, near = cv2.erode(disparity, window), cv2.dilate(disparity, window)
    _vote(Lanes(LANES), VOTING, ranks, greys, disparity, grey, far, near, out)
    return out


@njit(**KERNEL)
def _vote(lanes, voting, ranks, greys, disparity, grey, far, near, out):
    h, w = disparity.shape
    # Windows and paths let a near surface grow over its neighbour by a pixel or two. Near a depth edge, the pixels of a
    # small window vote for one of the two surfaces, the more alike their grey value is, the more; the rest has no
    # choice.
    for y in range(h):
        for x in range(w):
            lowest, highest = int32(far[y, x]), int32(near[y, x])
            if highest - lowest >= JUMP:
                middle = np.int16((lowest + highest) >> 1)
                front = _majority(lanes, voting, ranks, greys, y, x, middle)
                if (disparity[y, x] > middle) != (front > 0) and front != 0:
                    out[y, x] = _mean_of_side(disparity, grey, y, x, middle, front > 0)


@inner()
def _majority(lanes, voting, ranks, greys, y, x, middle):
    """Return the votes for the front minus those for the back. A row of the window fits the lanes; not all vote."""
    own = splat(lanes, greys[y + VOTERS, x + VOTERS])
    border, one = splat(lanes, uint16(middle + ZERO_RANK)), splat(lanes, uint16(1))
    reach = splat(lanes, uint16(GREY_REACH))
    voters = load(lanes, voting, 0)
    front = every = splat(lanes, uint16(0))
    for v in range(y, y + 2 * VOTERS + 1, STRIDE):
        rank, shade = load(lanes, ranks[v], x), load(lanes, greys[v], x)
        difference = subtract(maximum(shade, own), minimum(shade, own))
        weight = multiply(subtract(reach, minimum(difference, reach)), voters)
        every = add(every, weight)
        front = add(front, multiply(weight, minimum(subtract(maximum(rank, border), border), one)))
    return 2 * int32(total(front)) - int32(total(every))


@inner(error_model="python")
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
