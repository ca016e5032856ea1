"""How far a disparity can be trusted."""

# ruff: noqa: ANN001, ANN202 -- numba finds the types of what it compiles; the docstrings say them

import numpy as np
from jaxtyping import Bool, Float, Float32, Int16, UInt8
from numba import int32, njit

from tangible_core.threads import in_blocks

from .span import UNKNOWN

AGREEMENT = 16
"""Sixteenths of a pixel by which a final value may differ from the match that it is judged by."""
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
    table = by_quality.astype(np.float32)
    in_blocks(final.shape[0], lambda a, b: _judge(matched, final, quality, table, a, b, out))
    return out


def flat_pixels(grey: UInt8[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Where the 5 x 5 window holds one grey value only: nothing can be matched there."""
    import cv2

    window = np.ones((5, 5), np.uint8)
    return cv2.erode(grey, window) == cv2.dilate(grey, window)


@njit(nogil=True, boundscheck=False, cache=True)
def _judge(matched, final, quality, table, y0, y1, out):
    for y in range(y0, y1):
        for x in range(final.shape[1]):
            near = abs(int32(matched[y, x]) - int32(final[y, x])) <= AGREEMENT
            known = matched[y, x] != UNKNOWN and near
            out[y, x] = table[quality[y, x]] if known else np.float32(FILLED)
