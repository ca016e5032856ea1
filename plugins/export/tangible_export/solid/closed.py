"""A closed solid under a surface: its walls and its floor."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from tangible_core.data import Record

from .patches import Patch

STEPS_PER_MM = 100_000
"""Steps of coordinates in a millimetre: files of text hold five decimals."""


@dataclass(frozen=True, eq=False)
class Solid(Record):
    """A closed surface whose lower left front corner is at 0, x to the right, y to the back, z up.

    Each triangle runs counter-clockwise as seen from outside.
    """

    vertices_mm: Float64[np.ndarray, "n 3"]
    triangles: Int64[np.ndarray, "m 3"]


def close_solid(upper: Patch, base_m: float) -> Solid:
    """Return the solid below a surface whose outline is a rectangle from (0, 0) on; its floor is `base_m` below z = 0.

    Coinciding points of patches become one vertex; triangles with fewer than three different vertices are dropped.
    """
    raised_m = upper.points_m + np.array([0.0, 0.0, base_m])
    points = np.rint(1000 * STEPS_PER_MM * raised_m).astype(np.int64)
    vertices, triangles = _weld(points, upper.triangles)
    start, end = _outline(vertices, triangles)
    count, rim = len(vertices), len(start)
    foot = np.zeros(count, np.int64)
    foot[start] = count + np.arange(rim)
    centre = np.full(rim, count + rim)
    walls = [np.stack(each, axis=1) for each in ((end, start, foot[start]), (end, foot[start], foot[end]))]
    floor = np.stack([foot[end], foot[start], centre], axis=1)
    below = np.concatenate([vertices[start], vertices.max(axis=0, keepdims=True) // 2]) * (1, 1, 0)
    return Solid(np.concatenate([vertices, below]) / STEPS_PER_MM, np.concatenate([triangles, *walls, floor]))


def _weld(
    points: Int64[np.ndarray, "n 3"], triangles: Int64[np.ndarray, "m 3"]
) -> tuple[Int64[np.ndarray, "v 3"], Int64[np.ndarray, "t 3"]]:
    order = np.lexsort(points.T)
    ordered = points[order]
    first = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    vertex = np.empty(len(points), np.int64)
    vertex[order] = first.cumsum() - 1
    corners = vertex[triangles]
    a, b, c = corners.T
    return ordered[first], corners[(a != b) & (b != c) & (c != a)]


def _outline(
    vertices: Int64[np.ndarray, "v 3"], triangles: Int64[np.ndarray, "t 3"]
) -> tuple[Int64[np.ndarray, " e"], Int64[np.ndarray, " e"]]:
    """Return starts and ends of the edges along the four sides: each vertex there is one start and one end."""
    far = vertices.max(axis=0)
    sides = np.stack([vertices[:, axis] == limit for axis in (0, 1) for limit in (0, far[axis])])
    edges = list[np.ndarray]()
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = triangles[:, a], triangles[:, b]
        edges.append(np.stack([start, end])[:, (sides[:, start] & sides[:, end]).any(axis=0)])
    start, end = np.concatenate(edges, axis=1)
    return start, end
