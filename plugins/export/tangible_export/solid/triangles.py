"""Triangles over a height map: as few as keep the error, or all of its nodes.

A node's place is (column, row) counted from the lower left; triangles run counter-clockwise as seen from above.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int32

from tangible_core.data.records import Record

ROUNDING_M = 2.5e-8
"""By which a coordinate in a file may be off: half a step of `closed`, and half a step of STL's floating point."""


@dataclass(frozen=True, eq=False)
class Triangles(Record):
    """The nodes that are kept, and the triangles between them."""

    column: Int32[np.ndarray, " n"]
    row: Int32[np.ndarray, " n"]
    height_m: Float64[np.ndarray, " n"]
    corners: Int32[np.ndarray, "m 3"]
    off_m: float = 0.0
    """How far they are from the height of a node at most."""


def few_triangles(
    heights: Float32[np.ndarray, "h w"], pitch_m: tuple[float, float], error_m: float, most: int
) -> Triangles:
    """Nodes are added where the error is largest until it is nowhere above `error_m`, or there are `most` triangles.

    heights: at least 2 x 2 nodes.
    Something is left of the error for the rounding of coordinates in files, which tells most where it is steep.

    Raises: ImportError without pydelatin.
    Source: Garland & Heckbert, Fast polygonal approximation of terrains and height fields, 1995, sec. 4.
    """
    from pydelatin import Delatin

    steepest = sum(
        float(np.abs(np.diff(heights, axis=axis)).max()) / pitch for axis, pitch in zip((1, 0), pitch_m, strict=True)
    )
    allowed_m = max(error_m / 2, error_m - ROUNDING_M * (1 + 2 * steepest))
    made = Delatin(np.ascontiguousarray(heights, np.float32), max_error=allowed_m, max_triangles=most)
    nodes = np.asarray(made.vertices)  # whose rows count from below
    column, row = (nodes[:, axis].astype(np.int32) for axis in (0, 1))
    corners = np.asarray(made.triangles).astype(np.int32)
    return Triangles(column, row, nodes[:, 2].astype(np.float64), corners, made.error)


def all_triangles(heights: Float32[np.ndarray, "h w"]) -> Triangles:
    """Two triangles for each four nodes."""
    row, column = np.indices(heights.shape, np.int32)
    number = np.arange(heights.size, dtype=np.int32).reshape(heights.shape)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]))
    corners = np.concatenate([np.stack([a, b, c], 1), np.stack([b, d, c], 1)])
    upright = heights[::-1].astype(np.float64)
    return Triangles(column.ravel(), row.ravel(), upright.ravel(), corners)
