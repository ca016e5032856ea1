"""Census codes: one bit a neighbour, "is it darker than the centre?". Codes are compared by their Hamming distance.

Source: Zabih & Woodfill, Non-parametric local transforms for computing visual correspondence, ECCV 1994. A code keeps
the order of grey values only, so that exposure, gain and gamma of the two pictures may differ.
"""

import numpy as np
from jaxtyping import UInt, UInt8, UInt32, UInt64
from numba import njit

from .workers import in_blocks

RADIUS = 2
BITS = (2 * RADIUS + 1) ** 2 - 1


def census(grey: UInt8[np.ndarray, "h w"]) -> UInt32[np.ndarray, "h w"]:
    """Codes of 24 bits from the 5 x 5 window; beyond the picture its edge is repeated."""
    codes = np.empty(grey.shape, np.uint32)
    padded = np.pad(grey, RADIUS, mode="edge")
    in_blocks(grey.shape[0], lambda a, b: _codes(padded, a, b, codes))
    return codes


def two_scale_census(
    grey: UInt8[np.ndarray, "h w"], fine_px: float, coarse_px: float
) -> UInt64[np.ndarray, "h w"]:
    """Codes of 48 bits: the census at two blurs (Gaussian sigma). The coarse half survives noise, the fine keeps edges."""
    import cv2

    fine, coarse = (census(cv2.GaussianBlur(grey, (0, 0), sigma)) for sigma in (fine_px, coarse_px))
    return fine.astype(np.uint64) << np.uint64(BITS) | coarse


@njit(nogil=True, boundscheck=False, cache=True)
def _codes(padded: np.ndarray, y0: int, y1: int, codes: UInt[np.ndarray, "h w"]) -> None:
    """Rows y0..y1-1, one neighbour after the other along a whole row: each inner loop is plain vector code."""
    w = codes.shape[1]
    one, none = np.uint32(1), np.uint32(0)
    for y in range(y0, y1):
        row = codes[y]
        row[:] = none
        centre = padded[y + RADIUS, RADIUS : RADIUS + w]
        for i in range(BITS + 1):
            if i == BITS // 2:
                continue
            dy, dx = divmod(i, 2 * RADIUS + 1)
            neighbour = padded[y + dy, dx : dx + w]
            for x in range(w):
                row[x] = (row[x] << one) | (one if neighbour[x] < centre[x] else none)
