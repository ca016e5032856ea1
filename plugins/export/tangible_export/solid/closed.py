"""Patches of a surface, which have the same points along a common edge, and a closed solid under them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from tangible_core.data import Record

STEPS_PER_MM = 100_000  # files of text hold five decimals


@dataclass(frozen=True, eq=False)
class Patch(Record):
    """A piece of a surface: x to the right, y to the back, z up from the upper side of the plate."""

    points_m: Float64[np.ndarray, "n 3"]
    triangles: Int64[np.ndarray, "m 3"]


def join_patches(patches: Iterable[Patch]) -> Patch:
    """Return all patches as one; common points are not merged."""
    points, triangles, count = list[np.ndarray](), list[np.ndarray](), 0
    for patch in patches:
        points.append(patch.points_m)
        triangles.append(patch.triangles + count)
        count += len(patch.points_m)
    return Patch(np.concatenate(points), np.concatenate(triangles))


def strip(inner: Float64[np.ndarray, "n 3"], outer: Float64[np.ndarray, "k 3"]) -> Patch:
    """Return the surface between two chains that run the same way, paired by length, `outer` to the right or below."""
    along_inner, along_outer = _shares(inner), _shares(outer)
    near_outer = len(inner) + np.searchsorted(along_outer, along_inner, "left")
    near_inner = np.searchsorted(along_inner, along_outer, "right")
    i, j = np.arange(len(inner) - 1), len(inner) + np.arange(len(outer) - 1)
    triangles = [np.stack([i + 1, i, near_outer], axis=1), np.stack([near_inner, j, j + 1], axis=1)]
    return Patch(np.concatenate([inner, outer]), np.concatenate(triangles).astype(np.int64))


def _shares(chain: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, " m"]:
    lengths = np.linalg.norm(np.diff(chain[:, :2], axis=0), axis=1).cumsum()
    return lengths / lengths[-1]


def wall(ring: Float64[np.ndarray, "n 3"], foot_m: float = 0.0) -> Patch:
    """Return the vertical wall below a ring of points that runs counter-clockwise."""
    count, lower = len(ring), ring.copy()
    lower[:, 2] = foot_m
    upper = np.arange(count)
    after = np.roll(upper, -1)
    sides = [np.stack([after, upper, count + upper], axis=1), np.stack([after, count + upper, count + after], axis=1)]
    return Patch(np.concatenate([ring, lower]), np.concatenate(sides).astype(np.int64))


def rectangle(left_m: float, front_m: float, right_m: float, back_m: float) -> Patch:
    """Return a flat rectangle at the upper side of the plate, without points between its corners."""
    corners = flat([(left_m, front_m), (right_m, front_m), (right_m, back_m), (left_m, back_m)])
    return Patch(corners, np.array([[0, 1, 2], [0, 2, 3]]))


def flat(places_m: Sequence[tuple[float, float]], height_m: float = 0.0) -> Float64[np.ndarray, "n 3"]:
    """Return points at one height."""
    return np.array([(x_m, y_m, height_m) for x_m, y_m in places_m], np.float64)


@dataclass(frozen=True, eq=False)
class Solid(Record):
    """A closed surface from 0 on, x right, y back, z up; triangles run counter-clockwise as seen from outside."""

    vertices_mm: Float64[np.ndarray, "n 3"]
    triangles: Int64[np.ndarray, "m 3"]


def close_solid(upper: Patch, base_m: float) -> Solid:
    """Return the solid below a rectangular surface from (0, 0) on; its floor is `base_m` below z = 0."""
    raised_m = upper.points_m + np.array([0.0, 0.0, base_m])
    points = np.rint(1000 * STEPS_PER_MM * raised_m).astype(np.int64)
    vertices, triangles = _weld(points, upper.triangles)
    start, end = _outline(vertices, triangles)
    count, rim = len(vertices), len(start)
    foot = np.zeros(count, np.int64)
    foot[start] = count + np.arange(rim)
    centre = np.full(rim, count + rim)
    walls = [np.stack(corners, axis=1) for corners in ((end, start, foot[start]), (end, foot[start], foot[end]))]
    floor = np.stack([foot[end], foot[start], centre], axis=1)
    below = np.concatenate([vertices[start], vertices.max(axis=0, keepdims=True) // 2]) * (1, 1, 0)
    return Solid(np.concatenate([vertices, below]) / STEPS_PER_MM, np.concatenate([triangles, *walls, floor]))


def _weld(
    points: Int64[np.ndarray, "n 3"], triangles: Int64[np.ndarray, "m 3"]
) -> tuple[Int64[np.ndarray, "v 3"], Int64[np.ndarray, "t 3"]]:
    order = np.lexsort(points.T)
    sequence = points[order]
    first = np.concatenate([[True], (sequence[1:] != sequence[:-1]).any(axis=1)])
    vertex = np.empty(len(points), np.int64)
    vertex[order] = first.cumsum() - 1
    corners = vertex[triangles]
    a, b, c = corners.T
    return sequence[first], corners[(a != b) & (b != c) & (c != a)]


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
