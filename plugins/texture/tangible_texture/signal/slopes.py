"""Slopes of a smoothed picture: magnitude, direction, and the noise in them."""

from math import log, sqrt

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.compiled import KERNEL, inner, njit
from tangible_core.runtime import plain_opencv

TILE_PX = 128
"""The side of the tiles in which noise is measured, px."""

QUIET_SHARE = 0.25
"""The share of the pixels of a tile assumed to hold noise and no edge, at least."""

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
