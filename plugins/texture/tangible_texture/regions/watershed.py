"""Watershed by flooding, with one queue for each level, and its seeds, flat basins. Compiled by numba."""

from collections.abc import Iterable

import cv2
import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.compiled import KERNEL, inner, njit

# The number of levels of height; low ones, where most waters meet, are finer than high ones.
LEVELS = 1024
TILE_PX = 512
# The margin flooded around a tile, px: more than the distance between two flat basins.
AROUND_PX = 32
UNSEEN = -1
_OUTSIDE = -2
_LAST = -1
_UNQUEUED = -2
# The columns of the state of a pixel, contiguous because the flood jumps about in memory.
_LABEL, _LEVEL, _NEXT = range(3)


Heights = Float32[np.ndarray, "h w"]
Labels = Int32[np.ndarray, "h w"]


def watershed(height: Heights, markers: Labels) -> Labels:
    """Flood a landscape (>= 0) from markers, -1 elsewhere: each pixel gets the one whose water reaches it first."""
    top = float(height.max())
    scale = np.float32((LEVELS - 1) / np.sqrt(top) if top else 0)
    labels = np.empty_like(markers)
    # Meyer, Un algorithme optimal pour la ligne de partage des eaux, 1991, over 4 neighbours, without sheds; the queue
    # is an array of lists, one a level. No water comes from beyond a tile's margin unless a tile has no marker.
    for row in range(0, len(height), TILE_PX):
        for column in range(0, height.shape[1], TILE_PX):
            _flood_tile(labels, row, column, height, markers, scale)
    return labels if labels.min() > UNSEEN else _flood(height, labels, scale)


def _flood_tile(result: Labels, row: int, column: int, height: Heights, markers: Labels, scale: np.float32) -> None:
    """Flood one tile with its margin, and keep the tile: a whole picture does not fit the cache."""
    top, left = max(0, row - AROUND_PX), max(0, column - AROUND_PX)
    window = np.s_[top : row + TILE_PX + AROUND_PX, left : column + TILE_PX + AROUND_PX]
    labels = _flood(np.ascontiguousarray(height[window]), np.ascontiguousarray(markers[window]), scale)
    inner = labels[row - top :, column - left :][:TILE_PX, :TILE_PX]
    result[row : row + TILE_PX, column : column + TILE_PX] = inner


def _flood(height: Heights, markers: Labels, scale: np.float32) -> Labels:
    rows, columns = height.shape
    cells, labels = np.empty(((rows + 2) * (columns + 2), 3), np.int32), np.empty_like(markers)
    _pour(height, markers, scale, cells, np.full(LEVELS, _LAST, np.int32), np.empty(LEVELS, np.int32), labels)
    return labels


@njit(**KERNEL)
def _pour(height, markers, scale, cells, first, last, labels):
    rows, columns = height.shape
    width = columns + 2
    _frame(height, markers, scale, cells)
    neighbours = (-width, -1, 1, width)
    for pixel in range(len(cells)):
        if cells[pixel, _LABEL] == UNSEEN:
            for step in neighbours:
                if cells[pixel + step, _LABEL] >= 0 and cells[pixel + step, _NEXT] == _UNQUEUED:
                    _append(pixel + step, np.int64(cells[pixel + step, _LEVEL]), cells, first, last)
    # A queue for each level, first in, first out. A pixel below the flood joins the queue of the present level, so that
    # no level is visited twice. A frame that counts as outside spares the tests for the picture's border.
    for level in range(LEVELS):
        pixel = first[level]
        while pixel != _LAST:
            for step in neighbours:
                neighbour = pixel + step
                if cells[neighbour, _LABEL] == UNSEEN:
                    cells[neighbour, _LABEL] = cells[pixel, _LABEL]
                    _append(neighbour, max(level, np.int64(cells[neighbour, _LEVEL])), cells, first, last)
            pixel = cells[pixel, _NEXT]
    for row in range(rows):
        for column in range(columns):
            labels[row, column] = cells[(row + 1) * width + column + 1, _LABEL]


@inner()
def _frame(height, markers, scale, cells):
    """Copy the pixels into a frame one pixel wide that counts as outside."""
    rows, columns = height.shape
    for column in range(columns + 2):
        cells[column, _LABEL] = cells[(rows + 1) * (columns + 2) + column, _LABEL] = _OUTSIDE
    for row in range(rows):
        at = (row + 1) * (columns + 2)
        cells[at, _LABEL] = _OUTSIDE
        cells[at + columns + 1, _LABEL] = _OUTSIDE
        for column in range(columns):
            at += 1
            cells[at, _LABEL], cells[at, _NEXT] = markers[row, column], _UNQUEUED
            cells[at, _LEVEL] = np.int32(np.sqrt(height[row, column]) * scale)


@inner()
def _append(pixel, level, cells, first, last):
    cells[pixel, _NEXT] = _LAST
    if first[level] == _LAST:
        first[level] = pixel
    else:
        cells[last[level], _NEXT] = pixel
    last[level] = pixel


# The largest number of segments under `auto`, far more than touch can distinguish.
MAX_SEGMENTS = 64
# The multiples of the flat threshold, tried in turn where nothing is flat enough.
STEEPER = (1, 4, 16)
_SEVERAL = -2


def basins(
    height: Float32[np.ndarray, "h w"], levels: Iterable[float], smallest_px: int
) -> tuple[Int32[np.ndarray, "h w"], int]:
    """Label connected parts (4 neighbours) of smallest_px or more at or under rising levels, -1 elsewhere."""
    labels = np.full(height.shape, UNSEEN, np.int32)
    count = 0
    # At a higher level, a part without a basin becomes a new one: a rough object between smooth ones has its own,
    # although it is nowhere as flat. A part with one basin is all of that basin: water fills it before it flows over.
    for level in levels:
        size, parts = cv2.connectedComponents((height <= level).view(np.uint8), connectivity=4)
        owners, areas = np.full(size, UNSEEN, np.int32), np.zeros(size, np.int32)
        count = _label_parts(labels, parts, owners, areas, smallest_px, count)
    return labels, count


@njit(**KERNEL)
def _label_parts(labels, parts, names, areas, smallest_px, count):
    """Give every part with one basin to that basin, every large part without one to a new basin, from `count` on."""
    _find_owners(labels, parts, names, areas)
    names[0] = _SEVERAL  # part 0 is above the level
    for part in range(1, names.size):
        if names[part] == UNSEEN and areas[part] >= smallest_px:
            names[part] = count
            count += 1
    for row in range(labels.shape[0]):
        for column in range(labels.shape[1]):
            labels[row, column] = max(labels[row, column], names[parts[row, column]], UNSEEN)
    return count


@inner()
def _find_owners(labels, parts, owners, areas):
    """Write the basin in each part, -1 if there is none, -2 if there are several; and the areas of the parts."""
    for row in range(labels.shape[0]):
        for column in range(labels.shape[1]):
            part, basin = parts[row, column], labels[row, column]
            areas[part] += 1
            if basin >= 0 and owners[part] != basin:
                owners[part] = basin if owners[part] == UNSEEN else _SEVERAL
