"""The confidence of each disparity, 0..1."""

import cv2
import numpy as np
from jaxtyping import Bool, Float, Float32, Int16, UInt8
from numba import int32

from tangible_core.compiled import KERNEL, njit
from tangible_core.data import DisparityMap

from .span import UNKNOWN

# Largest difference, in sixteenths of a pixel, at which a final value still counts as its match.
AGREEMENT = 16
FLAT_REACH = 2  # radius, in pixels, of the window of `flat_pixels`: that of a census code
MIN_MATCHED = 0.2
FILLED = 0.1  # highest confidence of a value that comes from neighbours
STEP_REACH = 3  # radius, in pixels, of the window in which a depth step lowers the confidence
# Radius, in pixels, of the window in which pixels without a match lower the confidence.
GAP_REACH = 5
SHARE_LOST = 0.6  # share of the confidence lost where no pixel of the window was matched

Table = tuple[tuple[float, ...], tuple[float, ...]]
OF_FILLED: Table = (
    (0.01, 0.018, 0.033, 0.042, 0.056, 0.07, 0.079, 0.092),
    (0.563, 0.681, 0.823, 0.901, 0.944, 0.952, 0.952, 0.971),
)
"""Confidences of filled values, and the probability at each of being within 2 px (`benchmarks.depth_probability`)."""
OF_MATCHED: Table = (
    (0.203, 0.244, 0.281, 0.319, 0.359, 0.401, 0.441, 0.481, 0.526, 0.577, 0.655, 0.75, 0.887),
    (0.754, 0.834, 0.938, 0.968, 0.968, 0.97, 0.98, 0.986, 0.991, 0.995, 0.998, 0.999, 0.999),
)
"""The same for the range of matches."""


def probability(sure: Float32[np.ndarray, "*shape"]) -> Float32[np.ndarray, "*shape"]:
    """Return how likely a value of `semi-global` is within 2 px of the truth, 0..1, by its confidence."""
    filled_probability, matched_probability = (
        np.interp(sure, *table).astype(np.float32) for table in (OF_FILLED, OF_MATCHED)
    )
    return np.where(sure > np.float32(FILLED), matched_probability, filled_probability)


def confidence(
    matches: Int16[np.ndarray, "h w"],
    final: Int16[np.ndarray, "h w"],
    quality: UInt8[np.ndarray, "h w"],
    by_quality: Float[np.ndarray, "256"],
) -> Float32[np.ndarray, "h w"]:
    """Rate each pixel: MIN_MATCHED to by_quality[quality] where it agrees with its match, 0 to FILLED elsewhere."""
    window = np.ones((2 * STEP_REACH + 1, 2 * STEP_REACH + 1), np.uint8)
    missing = np.uint8(255) * (matches == UNKNOWN)
    gaps = cv2.blur(missing, (2 * GAP_REACH + 1, 2 * GAP_REACH + 1))
    out = np.empty(final.shape, np.float32)
    near, far = cv2.dilate(final, window), cv2.erode(final, window)
    _judge(matches, final, quality, by_quality.astype(np.float32), near, far, gaps, out)
    return out


def flat_pixels(grey: UInt8[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Find pixels whose 5 x 5 window is constant along its rows, so that every disparity fits equally well."""
    row = np.ones((1, 2 * FLAT_REACH + 1), np.uint8)
    level = (cv2.erode(grey, row) == cv2.dilate(grey, row)).view(np.uint8)
    return cv2.erode(level, row.T).view(np.bool_)


def zero_disparity(grey: UInt8[np.ndarray, "h w"], fill: bool) -> DisparityMap:
    """Return the map of two identical views: 0 everywhere, with confidence 0 for flat pixels, or NaN unless `fill`."""
    flat = flat_pixels(grey)
    unknown = flat & (not fill or bool(flat.all()))
    return DisparityMap(np.where(unknown, np.float32(np.nan), np.float32(0)), (~flat).astype(np.float32))


@njit(**KERNEL)
def _judge(matches, final, quality, table, near, far, gaps, out):
    least, highest_filled = np.float32(MIN_MATCHED), np.float32(FILLED)
    # Either range is scaled by (1 - SHARE_LOST m) / sqrt(1 + s), where s is the depth step in pixels near the pixel and
    # m the share of pixels near it without a match. The form comes from a logistic regression (which pixels are over 2
    # px off) over four photographs and four scenes.
    for y in range(final.shape[0]):
        for x in range(final.shape[1]):  # without the table, so that the loop vectorises
            step = np.float32(int32(near[y, x]) - int32(far[y, x])) * np.float32(1 / 16)
            share = np.float32(1) - np.float32(SHARE_LOST / 255) * np.float32(gaps[y, x])
            out[y, x] = share / np.sqrt(np.float32(1) + step)
        for x in range(final.shape[1]):
            agrees = abs(int32(matches[y, x]) - int32(final[y, x])) <= AGREEMENT
            value = (
                least + (table[quality[y, x]] - least) * out[y, x]
            )  # read unconditionally: a branch here is unpredictable
            out[y, x] = value if agrees & (matches[y, x] != UNKNOWN) else highest_filled * out[y, x]
