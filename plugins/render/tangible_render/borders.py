"""The borders between labels as smooth lines, within the uncertainty of the staircase of cells, and their distance."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64

BLUR = 128
"""The number of averages of neighbours, which make a Gaussian with a standard deviation of 8 points of a line."""
PASSES = 5  # the number of Gaussians in a low-pass, the same as in `surface.dequantise`
# The number of low-passes, each clipped to half a cell around the staircase, the same as in `surface.dequantise`.
ROUNDS = 8

Points = Float64[np.ndarray, "n 2"]
# The points, coordinate by coordinate: neighbours are then taken in a third of the time.
Lanes = Float64[np.ndarray, "2 n"]


class Borders(NamedTuple):
    """The lines between labels, as points with up to two neighbours."""

    # The points (column, row) in cells, the first cell's centre at (0, 0); one for each side between two labels.
    at: Points
    # The points before and after each; the point itself where a line ends: at the rim, or where three labels meet.
    neighbours: Int64[np.ndarray, "n 2"]


def border_lines(labels: Int32[np.ndarray, "h w"]) -> Borders:
    """Return smooth lines between the labels; each point lies within half a cell of its cell side."""
    points, neighbours = _sides(labels)
    # The border lies within half a cell of the staircase of sides: each line is low-passed and clipped to the half
    # cells, in turn (projections onto convex sets, Youla & Webb, IEEE Trans. Medical Imaging 1, 1982). The low-pass 1 -
    # (1 - G)^5 does not shrink circles, so a border is straight at any angle, and corners stay within half a cell.
    at = lanes = np.ascontiguousarray(points.T)
    for _ in range(ROUNDS if len(points) else 0):
        at = np.clip(_low_pass(at, neighbours), lanes - 0.5, lanes + 0.5)
    return Borders(np.ascontiguousarray(at.T), neighbours)


def border_distance(
    labels: Int32[np.ndarray, "h w"], pitch_m: tuple[float, float], most_m: float
) -> Float32[np.ndarray, "h w"]:
    """Compute metres from each cell's centre (cells of pitch_m) to the nearest of `border_lines`, at most most_m."""
    distance_m = np.full(labels.shape, most_m, np.float32)
    lines = border_lines(labels)
    near = _near(labels, pitch_m, most_m)
    if not len(lines.at) or not near.any():
        return distance_m
    row, column = np.nonzero(near)
    places_m = np.column_stack([column, row]) * np.array(pitch_m)
    distance_m[near] = np.minimum(_distance_to_lines(places_m, lines, np.array(pitch_m), most_m), most_m)
    return distance_m


def _near(labels: Int32[np.ndarray, "h w"], pitch_m: tuple[float, float], most_m: float) -> np.ndarray:
    """Return a mask of cells that may be within most_m: those near cells at borders, half a cell from the line."""
    from scipy import ndimage

    from tangible_core.data import border_pixels

    bordering = border_pixels(labels)
    if not bordering.any():
        return bordering
    reach_m = most_m + 1.5 * float(np.hypot(*pitch_m))
    distances: Any = ndimage.distance_transform_edt(~bordering, sampling=pitch_m[::-1])
    return np.asarray(distances <= reach_m)


def _distance_to_lines(
    places_m: Float64[np.ndarray, "n 2"], lines: Borders, pitch_m: np.ndarray, most_m: float
) -> Float64[np.ndarray, "n"]:
    from scipy.spatial import KDTree

    at_m = lines.at * pitch_m
    nearest = KDTree(at_m).query(places_m, distance_upper_bound=most_m + float(np.hypot(*pitch_m)))[1]
    within = nearest < len(at_m)
    distance_m = np.full(len(places_m), np.inf)
    here, point = places_m[within], np.asarray(nearest)[within]
    to_both = [_distance_to_segment(here, at_m[point], at_m[lines.neighbours[point, side]]) for side in (0, 1)]
    distance_m[within] = np.minimum(*to_both)
    return distance_m


def _distance_to_segment(
    here: Float64[np.ndarray, "n 2"], start: Float64[np.ndarray, "n 2"], end: Float64[np.ndarray, "n 2"]
) -> Float64[np.ndarray, "n"]:
    way = end - start
    square = np.maximum((way * way).sum(axis=1), 1e-300)
    share = np.clip(((here - start) * way).sum(axis=1) / square, 0.0, 1.0)
    return np.hypot(*(here - start - share[:, None] * way).T)


def _low_pass(at: Lanes, neighbours: Int64[np.ndarray, "n 2"]) -> Lanes:
    ends = neighbours == np.arange(len(neighbours))[:, None]
    loose = ends.any(axis=1)
    before, after = (np.where(loose, np.arange(len(neighbours)), side) for side in neighbours.T)
    residual = at
    for _ in range(PASSES):
        residual = residual - _blur(residual, before, after)
    return at - residual


def _blur(at: Lanes, before: Int64[np.ndarray, "n"], after: Int64[np.ndarray, "n"]) -> Lanes:
    """Average points with their neighbours BLUR times; the ends of lines stay."""
    for _ in range(BLUR):
        mean = at.take(before, axis=1)
        mean += at.take(after, axis=1)
        mean *= 0.5
        mean += at
        mean *= 0.5
        at = mean
    return at


def _sides(labels: Int32[np.ndarray, "h w"]) -> tuple[Points, Int64[np.ndarray, "n 2"]]:
    """Return the middles of the cell sides between two labels, and the neighbours of each along the line."""
    columns = labels.shape[1]
    upright, level = np.argwhere(labels[:, 1:] != labels[:, :-1]), np.argwhere(labels[1:] != labels[:-1])
    at = np.vstack([upright[:, ::-1] + [0.5, 0.0], level[:, ::-1] + [0.0, 0.5]]) if len(upright) + len(level) else None
    if at is None:
        return np.zeros((0, 2)), np.zeros((0, 2), np.int64)
    corner = columns + 1
    (row, column), (row_level, column_level) = upright.T, level.T
    first = np.concatenate([row * corner + column + 1, (row_level + 1) * corner + column_level])
    last = np.concatenate([(row + 1) * corner + column + 1, (row_level + 1) * corner + column_level + 1])
    # Two sides are neighbours where they alone meet at a corner of cells; where three or four meet, lines end.
    ends = np.stack([first, last], axis=1)
    neighbours = np.repeat(np.arange(len(at))[:, None], 2, axis=1)
    _, which, counts = np.unique(ends.ravel(), return_inverse=True, return_counts=True)
    order = np.argsort(which.ravel(), kind="stable")
    starts = np.searchsorted(which.ravel()[order], np.flatnonzero(counts == 2))
    one, other = order[starts], order[starts + 1]
    neighbours.ravel()[one], neighbours.ravel()[other] = other // 2, one // 2
    return at, neighbours
