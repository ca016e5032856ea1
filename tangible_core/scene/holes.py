"""Holes of a map, filled from the background."""

import numpy as np
from jaxtyping import Float, Int, Shaped

from ..errors import GeometryError


def fill_rows(values: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """Fill holes (NaN) from the background, as places hidden in one view belong to the surface behind.

    Each hole takes the smaller, that is the farther, of its two known neighbours in the row, or the only one; a row
    without known values takes the nearest row with some, the upper one of two.
    Returns: (h, w) without NaN; the array itself if it has no hole.
    Raises: GeometryError if every value is unknown.
    Source: Hirschmueller, PAMI 2008, sec. 2.5 (occlusions are filled from the lower disparity).

    >>> fill_rows(np.float32([[1, np.nan, 3]]))
    array([[1., 1., 3.]], dtype=float32)
    """
    unknown = np.isnan(values)
    if unknown.all():
        raise GeometryError("holes cannot be filled: every value is unknown (NaN); use a map with some known values")
    if not unknown.any():
        return values
    before, after = _neighbours(unknown)
    walled = np.pad(values, ((0, 0), (0, 1)), constant_values=np.inf)  # both -1 and w mean the wall
    filled = np.minimum(np.take_along_axis(walled, before, axis=1), np.take_along_axis(walled, after, axis=1))
    empty: np.ndarray = np.all(unknown, axis=1)
    return filled[_nearest(~empty)] if empty.any() else filled


def _neighbours(unknown: Shaped[np.ndarray, "h w"]) -> tuple[Int[np.ndarray, "h w"], Int[np.ndarray, "h w"]]:
    """Return the column of the last known value up to each place (-1: none), and of the next one (w: none)."""
    width = unknown.shape[1]
    columns = np.arange(width, dtype=np.int32)
    before = np.maximum.accumulate(np.where(unknown, np.int32(-1), columns), axis=1)
    after = np.minimum.accumulate(np.where(unknown, np.int32(width), columns)[:, ::-1], axis=1)[:, ::-1]
    return before, after


def _nearest(known: Shaped[np.ndarray, "n"]) -> Int[np.ndarray, "n"]:
    """Return the index of the nearest known place, the lower one of two."""
    places, index = np.flatnonzero(known), np.arange(known.size)
    after = np.searchsorted(places, index)
    low, high = places[np.maximum(after - 1, 0)], places[np.minimum(after, places.size - 1)]
    return np.where(index - low <= high - index, low, high)
