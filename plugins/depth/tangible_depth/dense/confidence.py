"""The confidence of each disparity, 0..1."""

# ruff: noqa: ANN001, ANN202 -- numba infers the types of kernels; their docstrings give them

import numpy as np
from jaxtyping import Bool, Float, Float32, Int16, UInt8
from numba import int32

from tangible_core.compiled.compiling import KERNEL, njit

from .span import UNKNOWN

AGREEMENT = 16
"""Largest difference, in sixteenths of a pixel, at which a final value still counts as its match."""
FLAT_REACH = 2
"""Radius, in pixels, of the window of `flat_pixels`: that of a census code."""
LEAST_MATCHED = 0.2
"""Confidence of the worst match."""
FILLED = 0.1
"""Highest confidence of a value that comes from neighbours."""
STEP_REACH = 3
"""Radius, in pixels, of the window in which a depth step lowers the confidence."""
GAP_REACH = 5
"""Radius, in pixels, of the window in which pixels without a match lower the confidence."""
SHARE_LOST = 0.6
"""Share of the confidence lost where no pixel of the window was matched."""


def confidence(
    matched: Int16[np.ndarray, "h w"],
    final: Int16[np.ndarray, "h w"],
    quality: UInt8[np.ndarray, "h w"],
    by_quality: Float[np.ndarray, "256"],
) -> Float32[np.ndarray, "h w"]:
    """Rate each pixel: LEAST_MATCHED to by_quality[quality] where it agrees with its match, 0 to FILLED elsewhere.

    Either range is scaled by (1 - SHARE_LOST m) / sqrt(1 + s), where s is the depth step in pixels between the nearest
    and the farthest value near the pixel, and m the share of pixels near it without a match. The form comes from a
    logistic regression (which pixels are over 2 px off) over four photographs and four scenes.

    matched: disparity in sixteenths of a pixel, UNKNOWN without a match; final: the same after filling and sharpening.
    quality: cost or score of each match, the index into by_quality. Returns: float32 (h, w).
    """
    import cv2

    window = np.ones((2 * STEP_REACH + 1, 2 * STEP_REACH + 1), np.uint8)
    missing = np.uint8(255) * (matched == UNKNOWN)
    gaps = cv2.blur(missing, (2 * GAP_REACH + 1, 2 * GAP_REACH + 1))
    out = np.empty(final.shape, np.float32)
    near, far = cv2.dilate(final, window), cv2.erode(final, window)
    _judge(matched, final, quality, by_quality.astype(np.float32), near, far, gaps, out)
    return out


def flat_pixels(grey: UInt8[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Find pixels whose 5 x 5 window is constant along its rows, so that every disparity fits equally well."""
    import cv2

    row = np.ones((1, 2 * FLAT_REACH + 1), np.uint8)
    level = (cv2.erode(grey, row) == cv2.dilate(grey, row)).view(np.uint8)
    return cv2.erode(level, row.T).view(np.bool_)


@njit(**KERNEL)
def _judge(matched, final, quality, table, near, far, gaps, out):
    least, filled = np.float32(LEAST_MATCHED), np.float32(FILLED)
    for y in range(final.shape[0]):
        for x in range(final.shape[1]):  # without the table, so that the loop vectorises
            step = np.float32(int32(near[y, x]) - int32(far[y, x])) * np.float32(1 / 16)
            share = np.float32(1) - np.float32(SHARE_LOST / 255) * np.float32(gaps[y, x])
            out[y, x] = share / np.sqrt(np.float32(1) + step)
        for x in range(final.shape[1]):
            agrees = abs(int32(matched[y, x]) - int32(final[y, x])) <= AGREEMENT
            value = (
                least + (table[quality[y, x]] - least) * out[y, x]
            )  # read unconditionally: a branch here is unpredictable
            out[y, x] = value if agrees & (matched[y, x] != UNKNOWN) else filled * out[y, x]
