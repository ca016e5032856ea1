"""A closed solid under a surface: its walls and its floor."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from tangible_core.data.records import Record

from .patches import Patch

STEPS_PER_MM = 100_000
"""Coordinates are whole hundred-thousandths of a millimetre, as a file of text can say them."""


@dataclass(frozen=True, eq=False)
class Solid(Record):
    """A closed surface whose lower left front corner is at 0, x to the right, y to the back, z up.

    Each triangle runs counter-clockwise as seen from outside.
    """

    vertices_mm: Float64[np.ndarray, "n 3"]
    triangles: Int64[np.ndarray, "m 3"]


def closed(upper: Patch, base_m: float) -> Solid:
    """What lies below a surface whose outline is a rectangle from (0, 0) on, down to `base_m` below its level.

    Points of patches at one place are one vertex, and triangles between fewer than three vertices are none.
    """
    raised_m = upper.points_m + np.array([0.0, 0.0, base_m])
    points = np.rint(1000 * STEPS_PER_MM * raised_m).astype(np.int64)
    vertices, triangles = _welded(points, upper.triangles)
    start, end = _edges(triangles)[_single(triangles, len(vertices))].T  # each start is once, and so is each end
    count, rim = len(vertices), len(start)
    foot = np.zeros(count, np.int64)
    foot[start] = count + np.arange(rim)
    centre = np.full(rim, count + rim)
    walls = [np.stack(each, axis=1) for each in ((end, start, foot[start]), (end, foot[start], foot[end]))]
    floor = np.stack([foot[end], foot[start], centre], axis=1)
    below = np.concatenate([vertices[start], vertices.max(axis=0, keepdims=True) // 2]) * (1, 1, 0)
    return Solid(np.concatenate([vertices, below]) / STEPS_PER_MM, np.concatenate([triangles, *walls, floor]))


def _welded(
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


def _edges(triangles: Int64[np.ndarray, "m 3"]) -> Int64[np.ndarray, "e 2"]:
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def _single(triangles: Int64[np.ndarray, "m 3"], count: int) -> Bool[np.ndarray, " e"]:
    """Which edges no other triangle has the other way round."""
    start, end = _edges(triangles).T
    return ~np.isin(start * count + end, end * count + start)
