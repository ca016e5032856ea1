"""The raised pins: borders of parts, sought on the grid of the pins, so that none is lost; and heights between them."""

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int32, Integer, UInt8

from tangible_core.data import PartMap, Relief

from .displays import Display

MIN_CELLS = 4  # of the map, along a pin's side; a smaller map is enlarged

Place = tuple[slice, slice]


def place_picture(display: Display, shape: tuple[int, ...]) -> Place:
    """Return the place of a picture of this shape."""
    columns, rows = display.picture_size(shape[1] / shape[0])
    top, left = (display.rows - rows) // 2, (display.columns - columns) // 2
    return slice(top, top + rows), slice(left, left + columns)


def largest_shares(parts: PartMap, rows: int, columns: int) -> Int32[np.ndarray, "{rows} {columns}"]:
    """Return the part with the largest share of each pin's cell; of two equal parts, the one with the lower number."""
    labels = _enlarge(parts.labels, rows, columns)
    height, width = labels.shape
    row = (2 * np.arange(height) + 1) * rows // (2 * height)
    column = (2 * np.arange(width) + 1) * columns // (2 * width)
    cell = (row[:, None] * columns + column[None]).ravel().astype(np.int64)
    pairs, counts = np.unique(cell * parts.count + labels.ravel(), return_counts=True)
    cell, part = np.divmod(pairs, parts.count)
    most = np.zeros(rows * columns, np.int32)
    order = np.lexsort((-part, counts))
    most[cell[order]] = part[order]
    return most.reshape(rows, columns)


def _enlarge(labels: Int32[np.ndarray, "h w"], rows: int, columns: int) -> Int32[np.ndarray, "k l"]:
    down, right = (
        -(-MIN_CELLS * pins // cells) if cells < MIN_CELLS * pins else 1
        for pins, cells in zip((rows, columns), labels.shape, strict=True)
    )
    return labels.repeat(down, 0).repeat(right, 1)


def borders(parts: Int32[np.ndarray, "r c"]) -> Bool[np.ndarray, "r c"]:
    """Return the pins whose right or lower neighbour is in another part: a border is one pin wide."""
    border = np.zeros(parts.shape, np.bool_)
    border[:, :-1] |= parts[:, :-1] != parts[:, 1:]
    border[:-1] |= parts[:-1] != parts[1:]
    return border


def heights(relief: Relief, rows: int, columns: int, top: int) -> UInt8[np.ndarray, "{rows} {columns}"]:
    """Return the mean height in each pin's cell, scaled so that the highest is `top`; 0 everywhere if all is flat."""
    metres: Float32[np.ndarray, "h w"] = relief.height_m
    over = (metres - metres.min()).astype(np.float32)
    mean = cv2.resize(over, (columns, rows), interpolation=cv2.INTER_AREA)
    highest = float(mean.max())
    return np.rint(mean * (top / highest) if highest > 0 else mean * 0).astype(np.uint8)


def on_display(
    display: Display, picture: Integer[np.ndarray, "r c"], place: Place, outside: int
) -> Integer[np.ndarray, "rows columns"]:
    """Return a value for each pin of the display: those of the picture at its place, `outside` around it."""
    pins = np.full((display.rows, display.columns), outside, picture.dtype)
    pins[place] = picture
    return pins
