"""Which pins rise: borders of parts, found at the pins' own grid, so that none is lost; and heights between them."""

import numpy as np
from jaxtyping import Bool, Float32, Int32, UInt8

from tangible_core.data import PartMap, Relief

from .displays import Display

LEAST_CELLS = 4
"""Pixels a pin and side of the map that is counted: a smaller one is enlarged."""

Place = tuple[slice, slice]
"""Rows and columns of the display on which the picture lies, in its middle."""


def place_of(display: Display, shape: tuple[int, ...]) -> Place:
    """Where a picture of this shape lies."""
    columns, rows = display.fitted(shape[1] / shape[0])
    top, left = (display.rows - rows) // 2, (display.columns - columns) // 2
    return slice(top, top + rows), slice(left, left + columns)


def most_of(parts: PartMap, rows: int, columns: int) -> Int32[np.ndarray, "{rows} {columns}"]:
    """The part that fills most of each pin's cell: of two alike, the one with the lower number."""
    labels = _enlarged(parts.labels, rows, columns)
    height, width = labels.shape
    row = (2 * np.arange(height) + 1) * rows // (2 * height)
    column = (2 * np.arange(width) + 1) * columns // (2 * width)
    cell = (row[:, None] * columns + column[None]).ravel().astype(np.int64)
    pairs, counts = np.unique(cell * parts.count + labels.ravel(), return_counts=True)
    cell, part = np.divmod(pairs, parts.count)
    found = np.zeros(rows * columns, np.int32)
    order = np.lexsort((-part, counts))
    found[cell[order]] = part[order]
    return found.reshape(rows, columns)


def _enlarged(labels: Int32[np.ndarray, "h w"], rows: int, columns: int) -> Int32[np.ndarray, "k l"]:
    down, right = (
        -(-LEAST_CELLS * pins // cells) if cells < LEAST_CELLS * pins else 1
        for pins, cells in zip((rows, columns), labels.shape, strict=True)
    )
    return labels.repeat(down, 0).repeat(right, 1)


def borders(parts: Int32[np.ndarray, "r c"]) -> Bool[np.ndarray, "r c"]:
    """The pins whose right or lower neighbour is of another part: a border is one pin wide."""
    found = np.zeros(parts.shape, np.bool_)
    found[:, :-1] |= parts[:, :-1] != parts[:, 1:]
    found[:-1] |= parts[:-1] != parts[1:]
    return found


def heights(relief: Relief, rows: int, columns: int, top: int) -> UInt8[np.ndarray, "{rows} {columns}"]:
    """The mean height in each pin's cell, from 0 to `top` for the highest of them; 0 everywhere where all is flat."""
    import cv2

    metres: Float32[np.ndarray, "h w"] = relief.height_m
    over = (metres - metres.min()).astype(np.float32)
    mean = cv2.resize(over, (columns, rows), interpolation=cv2.INTER_AREA)
    highest = float(mean.max())
    return np.rint(mean * (top / highest) if highest > 0 else mean * 0).astype(np.uint8)


def raised(
    display: Display, border: Bool[np.ndarray, "r c"], area: UInt8[np.ndarray, "r c"] | None, place: Place
) -> UInt8[np.ndarray, "rows columns"]:
    """The heights of all pins: borders at the top, areas below them."""
    pins = np.zeros((display.rows, display.columns), np.uint8)
    pins[place] = np.where(border, display.levels, 0 if area is None else area)
    return pins


def whole(display: Display, parts: Int32[np.ndarray, "h w"], place: Place) -> Int32[np.ndarray, "rows columns"]:
    """The part of each pin of the display; -1 beside the picture."""
    found = np.full((display.rows, display.columns), -1, np.int32)
    found[place] = parts
    return found
