"""Smoothing before edge detection. Compiled by numba where every pixel is visited."""

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.compiled import KERNEL, njit
from tangible_core.runtime import plain_opencv

WIDER = 1.75
"""Ratio of the sigmas of regions and boundaries: larger, it detects weaker edges and loses narrow regions."""


def remove_specks(values: Float32[np.ndarray, "h w c"]) -> Float32[np.ndarray, "h w c"]:
    """Set a pixel further from its 8 neighbours than they are from one another to the nearest of their values."""
    if values.shape[0] * values.shape[1] == 1:
        return values
    # Conservative smoothing (Jain, Kasturi & Schunck, Machine Vision, 1995, ch. 4), limited by the spread: noise,
    # lines, corners and steps stay.
    around = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], np.uint8)
    lowest, highest = (extreme(values, around).reshape(values.shape) for extreme in (cv2.erode, cv2.dilate))
    calm = np.empty(values.size, values.dtype)
    _replace_specks(values.ravel(), lowest.ravel(), highest.ravel(), calm)
    return calm.reshape(values.shape)


@njit(**KERNEL)
def _replace_specks(values, lowest, highest, calm):
    """Set a value further outside of lowest..highest than these are apart to the nearer of them."""
    for at in range(values.size):
        value, low, high = values[at], lowest[at], highest[at]
        spread = high - low
        calm[at] = high if value - high > spread else low if low - value > spread else value


def gaussian(values: Float32[np.ndarray, "h w *c"], sigma_px: float) -> Float32[np.ndarray, "h w *c"]:
    """Smooth by a Gaussian; outside of the picture is its mirror image."""
    with plain_opencv():
        return cv2.GaussianBlur(values, (0, 0), sigma_px, borderType=cv2.BORDER_REFLECT).reshape(values.shape)


def smooth_at_two_scales(
    values: Float32[np.ndarray, "h w c"], sigma_px: float
) -> tuple[Float32[np.ndarray, "h w c"], Float32[np.ndarray, "r s c"], int]:
    """Smooth by sigma_px, and by WIDER times as much on a grid of every step-th pixel; return both and the step."""
    rows, columns = values.shape[:2]
    near_px, wide_px = (min(sigma, (rows * columns) ** 0.5 / 16) for sigma in (sigma_px, WIDER * sigma_px))
    # The second has little detail finer than its sigma.
    step = max(1, int(wide_px / 1.5))
    near = gaussian(values, near_px)
    whole = cv2.copyMakeBorder(near, 0, -rows % step, 0, -columns % step, cv2.BORDER_REPLICATE)
    size = whole.shape[1] // step, whole.shape[0] // step
    with plain_opencv():
        cells = cv2.resize(whole, size, interpolation=cv2.INTER_AREA).reshape(*size[::-1], -1)
    rest = wide_px**2 - near_px**2 - (step**2 - 1) / 12  # variances add up, that of a box of step pixels among them
    return near, gaussian(cells, rest**0.5 / step) if rest > 0 else cells, step
