"""Census codes: one bit a neighbour, "is it darker than the centre?". Codes are compared by their Hamming distance.

Source: Zabih & Woodfill, Non-parametric local transforms for computing visual correspondence, ECCV 1994. A code keeps
the order of grey values only, so that exposure, gain and gamma of the two pictures may differ.
"""

# ruff: noqa: ANN001, ANN201 -- numba finds the types of what it compiles; the docstrings say them

from collections.abc import Sequence

import numpy as np
from jaxtyping import UInt8
from numba import njit

from tangible_core.compiled.compiling import KERNEL
from tangible_core.compiled.threads import in_blocks

RADIUS = 2
PLANES = 3
"""Bytes of a code."""
BITS = 8 * PLANES
BLOCK = 64
"""Columns that a processor treats at once; whole blocks spare it the odd ones at a row's end."""
OFFSETS = np.array([(dy, dx) for dy in range(5) for dx in range(5) if (dy, dx) != (RADIUS, RADIUS)])


def census(grey: UInt8[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h 3 whole"]:
    """Codes of 24 bits from the 5 x 5 window, a plane a byte; beyond the picture its edge is repeated.

    Rows are completed to whole blocks of BLOCK columns; what stands there means nothing.
    """
    return _coded([grey])


def two_scale_census(
    grey: UInt8[np.ndarray, "h w"], fine_px: float, coarse_px: float
) -> UInt8[np.ndarray, "h 6 whole"]:
    """Codes of 48 bits: the census at two Gaussian blurs; the coarse half survives noise, the fine keeps edges."""
    import cv2

    return _coded([cv2.GaussianBlur(grey, (0, 0), sigma) for sigma in (fine_px, coarse_px)])


def with_levels(grey: UInt8[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h 4 whole"]:
    """The census, and as one more plane the grey values, halved."""
    codes = _coded([grey], spare_planes=1)
    np.right_shift(grey, 1, out=codes[:, PLANES, : grey.shape[1]])
    return codes


def _coded(greys: Sequence[np.ndarray], spare_planes: int = 0) -> UInt8[np.ndarray, "h planes whole"]:
    """The codes of several pictures of one size, side by side in the planes; the spare ones are 0."""
    import cv2

    h, w = greys[0].shape
    codes = np.zeros((h, PLANES * len(greys) + spare_planes, w + -w % BLOCK), np.uint8)
    for i, grey in enumerate(greys):
        padded = cv2.copyMakeBorder(grey, RADIUS, RADIUS, RADIUS, RADIUS + -w % BLOCK, cv2.BORDER_REPLICATE)
        in_blocks(h, lambda a, b, padded=padded, i=i: code_rows(padded, OFFSETS, PLANES * i, a, b, codes))
    return codes


@njit(**KERNEL)
def code_rows(padded, offsets, first_plane, y0, y1, codes):
    """Rows y0..y1-1, one neighbour after the other along a whole row: each inner loop is plain vector code."""
    w = codes.shape[2]
    for y in range(y0, y1):
        centre = padded[y + RADIUS, RADIUS : RADIUS + w]
        for i in range(BITS):
            plane = codes[y, first_plane + (i >> 3)]
            dy, dx = offsets[i]
            neighbour = padded[y + dy, dx : dx + w]
            bit = np.uint8(1 << (i & 7))
            for x in range(w):
                plane[x] |= bit if neighbour[x] < centre[x] else np.uint8(0)
