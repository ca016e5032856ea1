"""Patches of a surface: points in metres, and triangles that run counter-clockwise as seen from outside.

Adjacent patches have the same points along their common edge; `close_solid` makes one surface of them.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from tangible_core.data import Record


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
    """Return the surface between two chains of points that run the same way, `outer` to the right or below.

    Points of the two chains are paired by the share of the chain's whole length at which they lie.
    """
    along_inner, along_outer = _shares(inner), _shares(outer)
    near_outer = len(inner) + np.searchsorted(along_outer, along_inner, "left")
    near_inner = np.searchsorted(along_inner, along_outer, "right")
    i, j = np.arange(len(inner) - 1), len(inner) + np.arange(len(outer) - 1)
    triangles = [np.stack([i + 1, i, near_outer], axis=1), np.stack([near_inner, j, j + 1], axis=1)]
    return Patch(np.concatenate([inner, outer]), np.concatenate(triangles).astype(np.int64))


def _shares(chain: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, " m"]:
    """Return the share of the chain's length at each point but the first; 1 at the last."""
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
