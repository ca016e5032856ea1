"""Slopes of a smoothed picture: how steep, which way, and how much of it is noise."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

import numpy as np
from jaxtyping import Float32
from numba import njit

TILE_PX = 128
"""Side of the tiles in which noise is measured."""

QUIET_SHARE = 0.25
"""In every tile at least this share of the pixels is taken to hold noise and no edge."""

_QUIET_RATIO = np.float32(np.sqrt(-2 * np.log(1 - QUIET_SHARE)))
"""That quantile of a Rayleigh distribution, which slopes of Gaussian noise follow, over its parameter."""

Map = Float32[np.ndarray, "h w"]


def slopes(smooth: Float32[np.ndarray, "h w c"]) -> tuple[Map, Map, Map, Map]:
    """Slopes per pixel, by central differences, in the channel where they are steepest, and the noise in them.

    Noise is the parameter of its Rayleigh distribution, in the noisiest channel; it is measured in tiles, from the
    flattest quarter of their pixels, and interpolated between the tiles. A texture that fills its tile counts as noise,
    as does a steady shading.
    Returns: magnitude, across, down, noise.
    """
    import cv2

    across, down = (
        cv2.Sobel(smooth, cv2.CV_32F, *way, ksize=1, scale=0.5, borderType=cv2.BORDER_REPLICATE).reshape(smooth.shape)
        for way in ((1, 0), (0, 1))
    )
    magnitude = cv2.magnitude(across, down).reshape(smooth.shape)
    noise = _noise(magnitude)
    if smooth.shape[2] == 1:
        return magnitude[..., 0], across[..., 0], down[..., 0], noise
    return *_steepest(magnitude, across, down), noise


@njit(cache=True, nogil=True)
def _steepest(magnitude, across, down):
    rows, columns, channels = magnitude.shape
    found = np.empty((3, rows, columns), np.float32)
    for row in range(rows):
        for column in range(columns):
            best = 0
            for channel in range(1, channels):
                if magnitude[row, column, channel] > magnitude[row, column, best]:
                    best = channel
            found[0, row, column] = magnitude[row, column, best]
            found[1, row, column] = across[row, column, best]
            found[2, row, column] = down[row, column, best]
    return found[0], found[1], found[2]


def _noise(magnitude: Float32[np.ndarray, "h w c"]) -> Map:
    import cv2

    rows, columns = magnitude.shape[:2]
    step = 4 if min(rows, columns) >= TILE_PX else 1
    strips = np.array_split(magnitude[::step, ::step], _tiles(rows), axis=0)
    levels = [[_quiet(tile) for tile in np.array_split(strip, _tiles(columns), axis=1)] for strip in strips]
    return cv2.resize(np.array(levels, np.float32) / _QUIET_RATIO, (columns, rows), interpolation=cv2.INTER_LINEAR)


def _tiles(length: int) -> int:
    return max(1, round(length / TILE_PX))


def _quiet(tile: Float32[np.ndarray, "h w c"]) -> np.float32:
    """The quantile of the magnitudes, in the channel where it is highest."""
    every = tile.reshape(-1, tile.shape[2])
    at = int(QUIET_SHARE * len(every))
    return np.partition(every, at, axis=0)[at].max()
