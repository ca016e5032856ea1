"""A relief from an angle: parallel projection, facets from far to near, and heights under points."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32, Float64, Int64

from tangible_core.data import Relief
from tangible_core.scene import picture_to_workspace, resample, workspace_to_picture

ELEVATION_DEG, AZIMUTH_DEG = 42.0, -68.0
"""The direction of the view: from the user's side and a little from the right, so that two walls are visible."""
_UP, _ROUND = np.radians([ELEVATION_DEG, AZIMUTH_DEG])
SIGHT = np.array([np.cos(_UP) * np.cos(_ROUND), np.cos(_UP) * np.sin(_ROUND), np.sin(_UP)])
"""The unit vector from the relief to the reader."""
PAPER = np.array(
    [[-np.sin(_ROUND), np.cos(_ROUND), 0], [-np.sin(_UP) * np.cos(_ROUND), -np.sin(_UP) * np.sin(_ROUND), np.cos(_UP)]]
)
"""The unit vectors of the paper, rightward and upward."""


class Facets(NamedTuple):
    """Quadrangles on paper, from far to near, and the point of the surface that gives each its colour."""

    corners: Float64[np.ndarray, "n 4 2"]
    row: Int64[np.ndarray, " n"]
    column: Int64[np.ndarray, " n"]


def drawn_size(relief: Relief, most: int) -> Relief:
    """Resample the surface to at most `most` cells a side."""
    rows, columns = relief.height_m.shape
    scale = min(1.0, most / max(rows, columns))
    return resample(relief, (max(1, round(rows * scale)), max(1, round(columns * scale))))


def on_paper(points_m: Float[np.ndarray, "... 3"]) -> Float64[np.ndarray, "... 2"]:
    """Return the parallel projection of points in the workspace frame."""
    return points_m @ PAPER.T


def points_of(relief: Relief) -> Float64[np.ndarray, "h w 3"]:
    """Return the cell centres at their heights, in the workspace frame."""
    row, column = np.indices(relief.height_m.shape, np.float64)
    x_m, y_m = picture_to_workspace(column, row, relief.height_m.shape, relief.extent_m)
    return np.stack([x_m, y_m, relief.height_m], axis=-1)


def add_border(points_m: Float64[np.ndarray, "h w 3"], extent_m: tuple[float, float]) -> Float64[np.ndarray, "h2 w2 3"]:
    """Return the points with the border of the surface around them, at the heights next to it."""
    points_m = np.pad(points_m, ((1, 1), (1, 1), (0, 0)), "edge")
    points_m[:, [0, -1], 0] = np.array([-0.5, 0.5]) * extent_m[0]
    points_m[[0, -1], :, 1] = np.array([[0.5], [-0.5]]) * extent_m[1]
    return points_m


def facets(points_m: Float64[np.ndarray, "h w 3"]) -> Facets:
    """Return the quadrangles between neighbouring points; painted in this order, near ones hide far ones."""
    nearness = points_m[:-1, :-1, :2] @ SIGHT[:2]
    row, column = np.unravel_index(np.argsort(nearness, axis=None), nearness.shape)
    paper = on_paper(points_m)
    corners = [paper[row + down, column + right] for down, right in ((0, 0), (0, 1), (1, 1), (1, 0))]
    return Facets(np.stack(corners, axis=1), row, column)


def heights_under(relief: Relief, points_m: Float64[np.ndarray, "... 3"]) -> Float32[np.ndarray, "..."]:
    """Return the height of the cell below (or above) each point, metres; NaN outside the surface."""
    shape = rows, columns = relief.height_m.shape
    places = workspace_to_picture(points_m[..., 0], points_m[..., 1], shape, relief.extent_m)
    column, row = (np.floor(place + 0.5) for place in places)
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    height_m = relief.height_m[np.where(inside, row, 0).astype(int), np.where(inside, column, 0).astype(int)]
    return np.where(inside, height_m, np.nan)
