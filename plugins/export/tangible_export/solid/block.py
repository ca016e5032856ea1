"""The picture as a block with steep sides that stands on the plate."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from tangible_core.data import Relief

from .patches import Patch
from .triangles import Triangles


class Block(NamedTuple):
    """The upper side of the block, and the ring of points at its edge, counter-clockwise from the lower left.

    corners: where in the ring its four corners are.
    """

    top: Patch
    ring_m: Float64[np.ndarray, "r 3"]
    corners: tuple[int, int, int, int]


def block(relief: Relief, triangles: Triangles, at_m: tuple[float, float]) -> Block:
    """The triangles over a relief, whose lower left corner is to lie at `at_m`.

    Its nodes are centres of cells. From the outermost of them, triangles as high as these go on to the edge of the
    picture, so that neither a height nor the picture's size is off.
    """
    rows, columns = relief.height_m.shape
    column, row = triangles.column, triangles.row
    across_m, down_m = relief.pitch_m
    inner = np.stack([at_m[0] + (column + 0.5) * across_m, at_m[1] + (row + 0.5) * down_m, triangles.height_m], axis=1)
    ring, corners = _ring(column, row, columns, rows)
    edge = inner[ring]
    for axis, (place, last) in enumerate(((column[ring], columns - 1), (row[ring], rows - 1))):
        edge[place == 0, axis] = at_m[axis]
        edge[place == last, axis] = at_m[axis] + relief.extent_m[axis]
    outer = len(inner) + np.arange(len(ring))
    after, outer_after = np.roll(ring, -1), np.roll(outer, -1)
    sides = [np.stack([after, ring, outer], axis=1), np.stack([after, outer, outer_after], axis=1)]
    top = Patch(np.concatenate([inner, edge]), np.concatenate([triangles.corners.astype(np.int64), *sides]))
    return Block(top, edge, corners)


def _ring(
    column: np.ndarray, row: np.ndarray, columns: int, rows: int
) -> tuple[Int64[np.ndarray, " r"], tuple[int, int, int, int]]:
    """The outermost nodes, counter-clockwise from the lower left, and where among them the corners are."""
    right, back = columns - 1, rows - 1
    way = np.select(
        [row == 0, column == right, row == back, column == 0],
        [column, right + row, 2 * right + back - column, 2 * (right + back) - row],
        -1,
    )
    outermost = np.flatnonzero(way >= 0)
    ring = outermost[np.argsort(way[outermost], kind="stable")]
    found = np.searchsorted(way[ring], [0, right, right + back, 2 * right + back])
    return ring, (int(found[0]), int(found[1]), int(found[2]), int(found[3]))
