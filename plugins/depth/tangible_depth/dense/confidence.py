"""How far a disparity can be trusted."""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

import numpy as np
from jaxtyping import Bool, Float, Float32, Int16, UInt8
from numba import int32, njit

from tangible_core.compiled.compiling import KERNEL

from .span import UNKNOWN

AGREEMENT = 16
"""Sixteenths of a pixel by which a final value may differ from the match that it is judged by."""
FLAT_REACH = 2
"""Rows and columns round a pixel in which `flat_pixels` looks."""
LEAST_MATCHED, FILLED = 0.2, 0.1
"""Confidence of the worst match, and of a value that comes from neighbours."""


def confidence(
    matched: Int16[np.ndarray, "h w"],
    final: Int16[np.ndarray, "h w"],
    quality: UInt8[np.ndarray, "h w"],
    by_quality: Float[np.ndarray, "256"],
) -> Float32[np.ndarray, "h w"]:
    """by_quality[quality] where a match was found and the final value agrees with it, 0.1 elsewhere.

    matched (UNKNOWN where nothing was) and final in sixteenths of a pixel; quality, what each match cost or scored.
    """
    out = np.empty(final.shape, np.float32)
    _judge(matched, final, quality, by_quality.astype(np.float32), out)
    return out


def flat_pixels(grey: UInt8[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Where nothing changes along the rows of the 5 x 5 window: any shift along them fits as well as any other."""
    import cv2

    row = np.ones((1, 2 * FLAT_REACH + 1), np.uint8)
    level = (cv2.erode(grey, row) == cv2.dilate(grey, row)).view(np.uint8)
    return cv2.erode(level, row.T).view(np.bool_)


@njit(**KERNEL)
def _judge(matched, final, quality, table, out):
    for y in range(final.shape[0]):
        for x in range(final.shape[1]):
            near = abs(int32(matched[y, x]) - int32(final[y, x])) <= AGREEMENT
            value = table[quality[y, x]]  # read in any case: whether it counts, no processor can guess
            out[y, x] = value if near & (matched[y, x] != UNKNOWN) else np.float32(FILLED)
