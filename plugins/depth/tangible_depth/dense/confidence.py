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
"""Confidence of the worst match, and the highest of a value that comes from neighbours."""
STEP_REACH, GAP_REACH = 3, 5
"""Rows and columns round a pixel in which steps of depth and pixels without a match lessen its confidence."""
SHARE_LOST = 0.6
"""What of the confidence is lost where nothing round a pixel was matched."""


def confidence(
    matched: Int16[np.ndarray, "h w"],
    final: Int16[np.ndarray, "h w"],
    quality: UInt8[np.ndarray, "h w"],
    by_quality: Float[np.ndarray, "256"],
) -> Float32[np.ndarray, "h w"]:
    """LEAST_MATCHED up to by_quality[quality] where the final value agrees with a match, 0 up to FILLED elsewhere.

    Of either range there is (1 - SHARE_LOST m) / sqrt(1 + s): s is the step of depth in pixels between the nearest and
    the farthest value round the pixel, m the share of the pixels round it without a match. The form comes from a
    logistic regression (which pixels are over 2 px off) over four photographs and four scenes.

    matched (UNKNOWN where nothing was) and final in sixteenths of a pixel; quality, what each match cost or scored.
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
    """Where nothing changes along the rows of the 5 x 5 window: any shift along them fits as well as any other."""
    import cv2

    row = np.ones((1, 2 * FLAT_REACH + 1), np.uint8)
    level = (cv2.erode(grey, row) == cv2.dilate(grey, row)).view(np.uint8)
    return cv2.erode(level, row.T).view(np.bool_)


@njit(**KERNEL)
def _judge(matched, final, quality, table, near, far, gaps, out):
    least, filled = np.float32(LEAST_MATCHED), np.float32(FILLED)
    for y in range(final.shape[0]):
        for x in range(final.shape[1]):  # apart from the table, so that it is plain vector code
            step = np.float32(int32(near[y, x]) - int32(far[y, x])) * np.float32(1 / 16)
            share = np.float32(1) - np.float32(SHARE_LOST / 255) * np.float32(gaps[y, x])
            out[y, x] = share / np.sqrt(np.float32(1) + step)
        for x in range(final.shape[1]):
            agrees = abs(int32(matched[y, x]) - int32(final[y, x])) <= AGREEMENT
            value = least + (table[quality[y, x]] - least) * out[y, x]  # read in any case: no processor can guess
            out[y, x] = value if agrees & (matched[y, x] != UNKNOWN) else filled * out[y, x]
