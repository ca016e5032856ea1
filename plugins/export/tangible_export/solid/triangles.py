"""Triangles over a height map, by (column, row) from the lower left, counter-clockwise as seen from above."""

import logging
from dataclasses import dataclass
from math import sqrt

import cv2
import numpy as np
from jaxtyping import Float32, Float64, Int32

from tangible_core.data import Record, Relief
from tangible_core.plugins import note
from tangible_core.runtime import plain_opencv

log: logging.Logger = logging.getLogger(__name__)

MIN_NODES = 2
# Rounding error of a coordinate in a file: half a step of `closed`, and half a step of STL's floating point.
ROUNDING_M = 2.5e-8


@dataclass(frozen=True, eq=False)
class Triangles(Record):
    """The nodes of a surface and the triangles between them."""

    column: Int32[np.ndarray, " n"]
    row: Int32[np.ndarray, " n"]
    height_m: Float64[np.ndarray, " n"]
    corners: Int32[np.ndarray, "m 3"]
    off_m: float = 0.0


def sample_nodes(relief: Relief, most_nodes: int, cure: str) -> Relief:
    """Return the same surface with 2 x 2 to `most_nodes` nodes, averaged with a note where there are more."""
    rows, columns = (side if side >= MIN_NODES else 3 for side in relief.height_m.shape)
    if (nodes := rows * columns) > most_nodes:
        scale = sqrt(most_nodes / nodes)
        rows, columns = (max(MIN_NODES, int(scale * side)) for side in (rows, columns))
        rows = min(rows, max(MIN_NODES, most_nodes // columns))  # of a strip that is as narrow as it may be,
        columns = min(columns, max(MIN_NODES, most_nodes // rows))  # the length is cut further
        side_mm = 1000 * max(relief.extent_m[0] / columns, relief.extent_m[1] / rows)
        fault = f"heights are averaged over squares of {side_mm:.2g} mm, as {nodes / 1e6:.3g} million nodes"
        note(log, f"{fault} would take too much memory and too large a file; {cure}", logging.WARNING)
    return Relief(_resize(relief.height_m, (rows, columns)), relief.extent_m)


def _resize(heights: Float32[np.ndarray, "h w"], shape: tuple[int, int]) -> Float32[np.ndarray, "h2 w2"]:
    if shape == heights.shape:
        return heights
    smaller = shape[0] <= heights.shape[0] and shape[1] <= heights.shape[1]
    with plain_opencv():
        resized = cv2.resize(heights, shape[::-1], interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)
    return np.maximum(resized, 0).astype(np.float32)


def few_triangles(
    heights: Float32[np.ndarray, "h w"], pitch_m: tuple[float, float], error_m: float, most: int
) -> Triangles:
    """Add nodes where the error is largest until it is nowhere above `error_m`, or there are `most` triangles.

    heights: at least 2 x 2 nodes.
    Part of the error is reserved for the rounding of coordinates in files, which matters most on steep slopes.

    Raises: ImportError without pydelatin.
    Source: Garland & Heckbert, Fast polygonal approximation of terrains and height fields, 1995, sec. 4.
    """
    from pydelatin import Delatin

    steepest = sum(
        float(np.abs(np.diff(heights, axis=axis)).max()) / pitch for axis, pitch in zip((1, 0), pitch_m, strict=True)
    )
    allowed_m = max(error_m / 2, error_m - ROUNDING_M * (1 + 2 * steepest))
    mesh = Delatin(np.ascontiguousarray(heights, np.float32), max_error=allowed_m, max_triangles=most)
    nodes = np.asarray(mesh.vertices)  # whose rows count from below
    column, row = (nodes[:, axis].astype(np.int32) for axis in (0, 1))
    corners = np.asarray(mesh.triangles).astype(np.int32)
    return Triangles(column, row, nodes[:, 2].astype(np.float64), corners, mesh.error)


def all_triangles(heights: Float32[np.ndarray, "h w"]) -> Triangles:
    """Return two triangles for each square of four nodes."""
    row, column = np.indices(heights.shape, np.int32)
    number = np.arange(heights.size, dtype=np.int32).reshape(heights.shape)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]))
    corners = np.concatenate([np.stack([a, b, c], 1), np.stack([b, d, c], 1)])
    upright = heights[::-1].astype(np.float64)
    return Triangles(column.ravel(), row.ravel(), upright.ravel(), corners)
