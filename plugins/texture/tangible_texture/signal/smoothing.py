"""Smoothing before edge detection, and slopes of a smoothed picture with the noise in them. Compiled by numba."""

from math import log, sqrt

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.compiled import KERNEL, inner, njit
from tangible_core.runtime import plain_opencv

# Ratio of the sigmas of regions and boundaries: larger, it detects weaker edges and loses narrow regions.
WIDER = 1.75


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


TILE_PX = 128  # the side of the tiles in which noise is measured, px
# The share of the pixels of a tile assumed to hold noise and no edge, at least.
QUIET_SHARE = 0.25
_QUIET_RATIO = np.float32(sqrt(-2 * log(1 - QUIET_SHARE)))
"""The QUIET_SHARE quantile over the parameter of a Rayleigh distribution, that of slopes of Gaussian noise."""
_HALF = np.float32(0.5)

Map = Float32[np.ndarray, "h w"]


def slopes(smooth: Float32[np.ndarray, "h w c"]) -> tuple[Map, Map, Map, Map]:
    """Return magnitude, across and down in the steepest channel, by central differences, and the noise of slopes."""
    across, down = np.empty(smooth.shape, np.float32), np.empty(smooth.shape, np.float32)
    rows, across_rows, down_rows = (plane.reshape(len(smooth), -1) for plane in (smooth, across, down))
    _differences(rows, across_rows, down_rows, smooth.shape[2])
    magnitude = np.sqrt(across * across + down * down)
    # The parameter of its Rayleigh distribution, in the noisiest channel, from the flattest quarter of each tile: a
    # texture that fills its tile counts as noise, as does a steady shading.
    noise = _noise(magnitude)
    if smooth.shape[2] == 1:
        return magnitude[..., 0], across[..., 0], down[..., 0], noise
    result = np.empty((3, *magnitude.shape[:2]), np.float32)
    _steepest(magnitude, across, down, result)
    return result[0], result[1], result[2], noise


@njit(**KERNEL)
def _differences(rows, across, down, channels):
    """Write central differences across and down; channels are interleaved in a row, and the border is repeated."""
    for row in range(len(rows)):
        _halve(rows[min(row + 1, len(rows) - 1)], rows[max(row - 1, 0)], down[row])
        here, there = rows[row], across[row]
        if here.size == channels:
            for at in range(channels):
                there[at] = 0
            continue
        _halve(here[2 * channels :], here[: -2 * channels], there[channels:-channels])
        _halve(here[channels : 2 * channels], here[:channels], there[:channels])
        _halve(here[-channels:], here[-2 * channels : -channels], there[-channels:])


@inner()
def _halve(right, left, result):
    for at in range(len(result)):
        result[at] = _HALF * (right[at] - left[at])


@njit(**KERNEL)
def _steepest(magnitude, across, down, result):
    rows, columns, channels = magnitude.shape
    for row in range(rows):
        for column in range(columns):
            best = 0
            for channel in range(1, channels):
                if magnitude[row, column, channel] > magnitude[row, column, best]:
                    best = channel
            result[0, row, column] = magnitude[row, column, best]
            result[1, row, column] = across[row, column, best]
            result[2, row, column] = down[row, column, best]


def _noise(magnitude: Float32[np.ndarray, "h w c"]) -> Map:
    rows, columns = magnitude.shape[:2]
    step = 4 if min(rows, columns) >= TILE_PX else 1
    strips = np.array_split(magnitude[::step, ::step], _tiles(rows), axis=0)
    levels = [[_quiet_level(tile) for tile in np.array_split(strip, _tiles(columns), axis=1)] for strip in strips]
    with plain_opencv():
        return cv2.resize(np.array(levels, np.float32) / _QUIET_RATIO, (columns, rows), interpolation=cv2.INTER_LINEAR)


def _tiles(length: int) -> int:
    return max(1, round(length / TILE_PX))


def _quiet_level(tile: Float32[np.ndarray, "h w c"]) -> np.float32:
    """Return the QUIET_SHARE quantile of the magnitudes, in the channel where it is highest."""
    every = tile.reshape(-1, tile.shape[2])
    at = int(QUIET_SHARE * len(every))
    return np.partition(every, at, axis=0)[at].max()
