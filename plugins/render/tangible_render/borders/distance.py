"""The distance of each cell of a surface from the nearest border between its labels."""

from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, Int32

from .lines import Borders, border_lines


def border_distance(
    labels: Int32[np.ndarray, "h w"], pitch_m: tuple[float, float], most_m: float
) -> Float32[np.ndarray, "h w"]:
    """Compute metres from each cell's centre to the nearest line of `border_lines`, at most most_m.

    pitch_m: width and length of a cell. Distances are to the segments between the points, not to the points.
    """
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

    from tangible_core.data.views import border_pixels

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
    """Compute distances from points to straight segments; a segment of no length is a point."""
    way = end - start
    square = np.maximum((way * way).sum(axis=1), 1e-300)
    share = np.clip(((here - start) * way).sum(axis=1) / square, 0.0, 1.0)
    return np.hypot(*(here - start - share[:, None] * way).T)
