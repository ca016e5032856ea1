"""Between which heights a spline surface lies, tile by tile: what lets a tick be decided without reading the spline."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from jaxtyping import Float32

from .coefficients import BORDER

TILE_CELLS, MOST_TILES = 16, 256


def tile_bounds(coefficients: Float32[np.ndarray, "h4 w4"]) -> Float32[np.ndarray, "r c 2"]:
    """An upper and a lower bound of the surface over each of r x c equal tiles: of 16 cells, or 256 tiles a side.

    A B-spline lies nowhere over the greatest of the 4 x 4 coefficients that it is made of, nor under the least: its
    weights are positive and sum to 1. Where the two bounds of a tile are equal, the surface is level there.
    """
    highest, lowest = coefficients, coefficients
    for axis in (0, 1):
        highest, lowest = _reduce(np.max, highest, axis), _reduce(np.min, lowest, axis)
    return np.ascontiguousarray(np.stack([highest, lowest], axis=2))


def _reduce(extreme: Callable[..., np.ndarray], values: np.ndarray, axis: int) -> np.ndarray:
    """One value a tile along this axis, over all coefficients that a point in it or at its edge depends on."""
    lines = np.moveaxis(values, axis, 0)
    cells = len(lines) - 2 * BORDER
    count = min(-(-cells // TILE_CELLS), MOST_TILES)
    edges = np.floor(np.arange(count + 1) * cells / count).astype(int) + BORDER
    return np.moveaxis(np.stack([extreme(lines[max(a - 3, 0) : b + 4], axis=0) for a, b in pairwise(edges)]), 0, axis)
