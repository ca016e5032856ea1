"""Slopes of a smoothed picture: how steep, which way, and how much of it is noise. Compiled by numba."""

# ruff: noqa: ANN001, ANN201, ANN202 -- numba takes the types from the call

import numpy as np
from jaxtyping import Float32
from numba import njit

TILE_PX = 128
"""Side of the tiles in which noise is measured."""

QUIET_SHARE = 0.25
"""In every tile at least this share of the pixels is taken to hold noise and no edge."""

_QUIET_RATIO = np.float32(np.sqrt(-2 * np.log(1 - QUIET_SHARE)))
"""That quantile of a Rayleigh distribution, which slopes of Gaussian noise follow, over its parameter."""


@njit(cache=True, nogil=True)
def _central(smooth, row, column, channel):
    """Half differences across the neighbours; the border pixel repeats outside."""
    rows, columns, _ = smooth.shape
    across = smooth[row, min(column + 1, columns - 1), channel] - smooth[row, max(column - 1, 0), channel]
    down = smooth[min(row + 1, rows - 1), column, channel] - smooth[max(row - 1, 0), column, channel]
    return across / np.float32(2), down / np.float32(2)


@njit(cache=True, nogil=True)
def slopes(smooth):
    """Slope in the channel where it is steepest (Di Zenzo's gradient, reduced to its largest part).

    Parameters: smooth float32 (h, w, c).
    Returns: magnitude, across, down: float32 (h, w), per pixel.
    """
    rows, columns, count = smooth.shape
    magnitude = np.empty((rows, columns), np.float32)
    across = np.empty((rows, columns), np.float32)
    down = np.empty((rows, columns), np.float32)
    for row in range(rows):
        for column in range(columns):
            steepest = np.float32(-1)
            for channel in range(count):
                x, y = _central(smooth, row, column, channel)
                if x * x + y * y > steepest:
                    steepest = x * x + y * y
                    across[row, column], down[row, column] = x, y
            magnitude[row, column] = np.sqrt(steepest)
    return magnitude, across, down


@njit(cache=True, nogil=True)
def _sampled(smooth, step):
    """Slope in every channel of every step-th pixel."""
    rows, columns, count = smooth.shape
    found = np.empty(((rows - 1) // step + 1, (columns - 1) // step + 1, count), np.float32)
    for row in range(found.shape[0]):
        for column in range(found.shape[1]):
            for channel in range(count):
                x, y = _central(smooth, row * step, column * step, channel)
                found[row, column, channel] = np.sqrt(x * x + y * y)
    return found


def noise_slope(smooth: Float32[np.ndarray, "h w c"]) -> Float32[np.ndarray, "h w"]:
    """The slope that noise has hereabouts: the parameter of its Rayleigh distribution, in the noisiest channel.

    Measured in tiles from the flattest quarter of their pixels, and interpolated between the tiles. A texture that
    fills its tile counts as noise, as does a steady shading.
    """
    import cv2

    rows, columns = smooth.shape[:2]
    found = _sampled(smooth, 4 if min(rows, columns) >= TILE_PX else 1)
    levels = [
        [_quiet(tile) for tile in np.array_split(strip, _tiles(columns), axis=1)]
        for strip in np.array_split(found, _tiles(rows), axis=0)
    ]
    return cv2.resize(np.array(levels, np.float32) / _QUIET_RATIO, (columns, rows), interpolation=cv2.INTER_LINEAR)


def _quiet(tile: Float32[np.ndarray, "h w c"]) -> np.float32:
    """The quantile of the slopes in the channel where it is highest."""
    every = tile.reshape(-1, tile.shape[2])
    at = int(QUIET_SHARE * len(every))
    return np.partition(every, at, axis=0)[at].max()


def _tiles(length: int) -> int:
    return max(1, round(length / TILE_PX))
