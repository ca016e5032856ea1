"""Watershed by flooding, with one queue a level. Compiled by numba."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

import numpy as np
from jaxtyping import Float32, Int32
from numba import njit

LEVELS = 4096
"""Heights are told apart to this share of the highest."""

UNSEEN = -1
_OUTSIDE = -2


def watershed(height: Float32[np.ndarray, "h w"], markers: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
    """Flood a landscape from markers: each pixel gets the marker whose water reaches it first, over its 4 neighbours.

    Parameters: height >= 0; markers, -1 where there is none.
    Returns: labels, those of the markers; no pixel is left on a shed. Where there is no marker at all, all are -1.
    Source: Meyer, Un algorithme optimal pour la ligne de partage des eaux, 1991; the queue is an array of first-in
    first-out lists, one a level.
    """
    top = float(height.max())
    return _flood(height, markers, np.float32((LEVELS - 1) / top if top else 0))


@njit(cache=True, nogil=True)
def _framed(height, markers, scale):
    """Levels and labels in a frame one pixel wide that counts as outside, flat."""
    rows, columns = height.shape
    levels = np.zeros((rows + 2, columns + 2), np.uint16)
    labels = np.full((rows + 2, columns + 2), _OUTSIDE, np.int32)
    for row in range(rows):
        for column in range(columns):
            levels[row + 1, column + 1] = np.uint16(height[row, column] * scale)
            labels[row + 1, column + 1] = markers[row, column]
    return levels.ravel(), labels.ravel()


@njit(cache=True, nogil=True)
def _flood(height, markers, scale):
    rows, columns = height.shape
    width = columns + 2
    levels, labels = _framed(height, markers, scale)
    following = np.full(labels.size, -1, np.int32)  # the next pixel in the same queue
    first = np.full(LEVELS, -1, np.int32)
    last = np.empty(LEVELS, np.int32)
    neighbours = (-width, -1, 1, width)
    for pixel in range(labels.size):
        if labels[pixel] >= 0:
            shore = False
            for step in neighbours:
                shore |= labels[pixel + step] == UNSEEN
            if shore:
                _append(pixel, levels[pixel], following, first, last)
    for level in range(LEVELS):
        pixel = first[level]
        while pixel >= 0:
            for step in neighbours:
                beside = pixel + step
                if labels[beside] == UNSEEN:
                    labels[beside] = labels[pixel]
                    _append(beside, max(level, levels[beside]), following, first, last)
            pixel = following[pixel]
    return labels.reshape(rows + 2, width)[1:-1, 1:-1].copy()


@njit(cache=True, nogil=True)
def _append(pixel, level, following, first, last):
    if first[level] < 0:
        first[level] = pixel
    else:
        following[last[level]] = pixel
    last[level] = pixel
