"""Smooth outlines of parts: the stairs of pixels become curves, which neighbours share to the bit."""

from typing import Any

import numpy as np
import shapely
from jaxtyping import Float64
from scipy.ndimage import gaussian_filter1d

from tangible_core.data import PartMap

from .borders import shared_borders

# Standard deviation of the Gaussian along an outline: a finger feels corners of this size, and no stairs below it.
SMOOTH_MM = 1.0
# Least standard deviation, in pixels of the map, so that the stairs of a coarse map go as well.
SMOOTH_PX = 2.0
NEAR_MM = 0.02  # of points left out: less than a printer draws


def smooth_borders(parts: PartMap, width_mm: float) -> tuple[Any, ...]:
    """Return shapely's polygons for each part, in millimetres, y up, origin in the middle, with smooth shared lines."""
    columns = parts.labels.shape[1]
    pitch_mm = width_mm / columns
    stairs = shared_borders(parts, width_mm, 0)
    rim = shapely.box(*shapely.total_bounds(stairs)).exterior
    lines = shapely.get_parts(shapely.line_merge(shapely.union_all([polygon.boundary for polygon in stairs])))
    sigma = max(SMOOTH_MM / pitch_mm, SMOOTH_PX)
    # Ends where three parts meet, and the rim, stay where they are.
    smooth = [line if rim.covers(line) else _smooth(line, pitch_mm, sigma) for line in lines]
    return _gather(shapely.get_parts(shapely.polygonize(smooth)), parts, stairs, pitch_mm)


def _smooth(line: Any, pitch_mm: float, sigma: float) -> Any:
    """Return a line of sides of pixels as a curve through their middles. sigma: in sides."""
    ends = shapely.get_coordinates(line)
    steps = np.round(np.abs(np.diff(ends, axis=0)).sum(axis=1) / pitch_mm).astype(int)
    at = np.concatenate(
        [_middles(one, other, n) for one, other, n in zip(ends, ends[1:], steps.tolist(), strict=False)]
    )
    is_closed = bool(line.is_closed)
    at = at if is_closed else np.concatenate([ends[:1], at, ends[-1:]])
    # Twice, so that a circle keeps its radius.
    once = blur(at, sigma, is_closed)
    twice = once + blur(at - once, sigma, is_closed)
    if is_closed:
        twice = np.concatenate([twice, twice[:1]])
    else:
        twice[[0, -1]] = ends[[0, -1]]
    return shapely.simplify(shapely.linestrings(twice), NEAR_MM)


def _middles(
    one: Float64[np.ndarray, " 2"], other: Float64[np.ndarray, " 2"], count: int
) -> Float64[np.ndarray, "n 2"]:
    return one + ((np.arange(count) + 0.5) / count)[:, None] * (other - one)


def blur(at: Float64[np.ndarray, "n 2"], sigma: float, closed: bool) -> Float64[np.ndarray, "n 2"]:
    """Return points blurred along their line; the ends of an open one stay, as it goes on mirrored in them."""
    if closed:
        return gaussian_filter1d(at, sigma, axis=0, mode="wrap")
    before, after = 2 * at[0] - at[:0:-1], 2 * at[-1] - at[-2::-1]
    return gaussian_filter1d(np.concatenate([before, at, after]), sigma, axis=0, mode="nearest")[
        len(before) : len(before) + len(at)
    ]


def _gather(faces: Any, parts: PartMap, stairs: tuple[Any, ...], pitch_mm: float) -> tuple[Any, ...]:
    """Return the faces of each part: those in which a pixel of it lies well inside."""
    rows, columns = parts.labels.shape
    at = shapely.get_coordinates(shapely.maximum_inscribed_circle(faces, tolerance=pitch_mm / 2))[::2]
    column = np.clip((at[:, 0] / pitch_mm + columns / 2).astype(int), 0, columns - 1)
    row = np.clip((rows / 2 - at[:, 1] / pitch_mm).astype(int), 0, rows - 1)
    number = parts.labels[row, column]
    return tuple(shapely.union_all(faces[number == part]) for part in range(len(stairs)))
