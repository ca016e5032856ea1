"""Bounds of a spline surface, tile by tile: many ticks are decided without reading the spline."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from jaxtyping import Float32

from .coefficients import BORDER

TILE_CELLS = 16
MAX_TILES = 256
"""The largest number of tiles along a side; larger grids have larger tiles."""


def tile_bounds(coefficients: Float32[np.ndarray, "h4 w4"]) -> Float32[np.ndarray, "r c 2"]:
    """Compute an upper and a lower bound of the surface over each of r x c equal tiles: of 16 cells, or 256 a side."""
    # A B-spline is nowhere above the greatest of its 4 x 4 coefficients, nor below the least: its weights are positive
    # and sum to 1. Where both bounds of a tile are equal, the surface is level.
    highest, lowest = coefficients, coefficients
    for axis in (0, 1):
        highest, lowest = _reduce(np.max, highest, axis), _reduce(np.min, lowest, axis)
    return np.ascontiguousarray(np.stack([highest, lowest], axis=2))


def _reduce(extreme: Callable[..., np.ndarray], values: np.ndarray, axis: int) -> np.ndarray:
    """Return one value for each tile along this axis, over all coefficients of the points in it and at its edge."""
    lines = np.moveaxis(values, axis, 0)
    cells = len(lines) - 2 * BORDER
    count = min(-(-cells // TILE_CELLS), MAX_TILES)
    edges = np.floor(np.arange(count + 1) * cells / count).astype(int) + BORDER
    return np.moveaxis(np.stack([extreme(lines[max(a - 3, 0) : b + 4], axis=0) for a, b in pairwise(edges)]), 0, axis)
