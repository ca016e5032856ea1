"""Borders between parts as polygons, which share their lines to the bit."""

from typing import Any

import numpy as np
import shapely
from jaxtyping import Bool, Float64, Int32, Int64

from tangible_core.data import PartMap, SegmentMap
from tangible_core.errors import GeometryError
from tangible_core.parts import find_parts

Sides = Int64[np.ndarray, "n"]
# Steps from one corner of a pixel to the next, by direction: 0 right, 1 down, 2 left, 3 up.
DOWN, RIGHT = np.array([0, 1, 0, -1]), np.array([1, 0, -1, 0])
BELOW, BEHIND = np.array([0, 1, 1, 0]), np.array([1, 1, 0, 0])
"""Offset from the upper left pixel at a corner to the pixel ahead on the left, by direction."""


def shared_borders(parts: PartMap, width_m: float, tolerance_m: float) -> tuple[Any, ...]:
    """Return a polygon for each part, by its number: two neighbours share the line between them to the bit.

    There is no gap and no overlap; holes stay holes; the picture's rim stays a rectangle. Lines run along the sides of
    pixels, and lose each corner whose triangle with the two next to it is smaller than tolerance_m squared, the
    smallest first, as long as no line crosses another. So the stairs of pixels become lines about as near as the
    tolerance, and places narrower than twice that, such as the tip of a tongue, may be cut off. 0 keeps every corner.
    Parameters: tolerance_m >= 0; width_m, of the whole picture.
    Returns: shapely's polygons, in metres, in the frame of the surface: x to the right, y away from the user, origin in
    the middle. A part of several pieces, of a reduced map, is a multipolygon, and one without a pixel an empty polygon.
    Raises: GeometryError if width_m is not positive or tolerance_m negative.
    Source: Visvalingam & Whyatt, Line generalisation by repeated elimination of points, 1993; for shared lines,
    `shapely.coverage_simplify`.
    """
    if not (0 < width_m < np.inf and 0 <= tolerance_m < np.inf):
        raise GeometryError(f"width_m and tolerance_m are lengths in metres, not {width_m} and {tolerance_m}")
    rows, columns = parts.labels.shape
    pieces = find_parts(SegmentMap(parts.labels))
    at, line, part = _rings(pieces)
    rings: Any = shapely.linearrings(at, indices=line)
    polygons: Any = shapely.polygons(rings, indices=part)
    if tolerance_m:
        polygons = shapely.coverage_simplify(polygons, tolerance_m * columns / width_m, simplify_boundary=False)
    middle, pitch_m = np.array([columns, rows]) / 2, width_m / columns * np.array([1, -1])

    def in_metres(at: Float64[np.ndarray, "k 2"]) -> Float64[np.ndarray, "k 2"]:
        return (at - middle) * pitch_m

    return _gather(shapely.transform(polygons, in_metres), np.asarray(pieces.segments), parts.count)


def _rings(parts: PartMap) -> tuple[Float64[np.ndarray, "k 2"], Int64[np.ndarray, "k"], Int64[np.ndarray, "m"]]:
    """Return corners (x, y) of closed lines, a part on the right of each; the line of each; the part of each line."""
    whole = np.pad(parts.labels, 1, constant_values=-1)  # so that a corner and its upper left pixel have one index
    corners = parts.labels.shape[1] + 1
    keys, part = _sides(whole, corners)
    start, way = np.divmod(keys, 4)
    row, column = np.divmod(start, corners)
    to_row, to_column = row + DOWN[way], column + RIGHT[way]
    on = _next_direction(whole, part, to_row, to_column, way)
    following = np.searchsorted(keys, (to_row * corners + to_column) * 4 + on)
    first, steps = _along(following)
    is_corner = _meet(whole, row, column)
    is_corner[following[on != way]] = True
    order = np.lexsort((-steps, first, part))  # a part's first side, at its topmost corner, is of its outer line
    order = order[is_corner[order]]
    begins = np.diff(first[order], prepend=-1) != 0
    at = np.stack([column[order], row[order]], axis=1).astype(np.float64)
    return at, np.cumsum(begins) - 1, part[order][begins]


def _sides(whole: Int32[np.ndarray, "r c"], corners: int) -> tuple[Int64[np.ndarray, "n"], Int64[np.ndarray, "n"]]:
    """Return sides of pixels between parts, once for each part: 4 * first corner + direction, sorted; and the part."""
    row, column = np.nonzero(whole[:-1, 1:-1] != whole[1:, 1:-1])
    corner = row * corners + column
    keys, parts = [4 * corner, 4 * (corner + 1) + 2], [whole[row + 1, column + 1], whole[row, column + 1]]
    row, column = np.nonzero(whole[1:-1, :-1] != whole[1:-1, 1:])
    corner = row * corners + column
    keys += [4 * corner + 1, 4 * (corner + corners) + 3]
    parts += [whole[row + 1, column], whole[row + 1, column + 1]]
    key, part = np.concatenate(keys).astype(np.int64), np.concatenate(parts).astype(np.int64)
    order = np.argsort(key)
    order = order[part[order] >= 0]
    return key[order], part[order]


def _next_direction(whole: Int32[np.ndarray, "r c"], part: Sides, row: Sides, column: Sides, way: Sides) -> Sides:
    """Return the direction from a corner: left, straight on or right, the first that has the part on its right."""
    # Where two pixels of a part touch only at a corner, the line passes to the other: none passes a corner twice.
    behind = (way + 1) % 4
    left = whole[row + BELOW[way], column + BEHIND[way]] == part
    straight = whole[row + BELOW[behind], column + BEHIND[behind]] == part
    return np.where(left, way + 3, np.where(straight, way, way + 1)) % 4


def _along(following: Sides) -> tuple[Sides, Sides]:
    """Return the least side of each side's ring, and the steps to its end, by pointer doubling."""
    first, ahead = np.arange(following.size), following
    while not np.array_equal(nearest := np.minimum(first, first[ahead]), first):
        first, ahead = nearest, ahead[ahead]
    ahead = np.where(following == first, np.arange(following.size), following)
    steps = (following != first).astype(np.int64)
    while (more := steps[ahead]).any():
        steps, ahead = steps + more, ahead[ahead]
    return first, steps


def _meet(whole: Int32[np.ndarray, "r c"], row: Sides, column: Sides) -> Bool[np.ndarray, "n"]:
    around = [whole[row + down, column + right] for down, right in zip(BELOW, BEHIND, strict=True)]
    sides = [one != other for one, other in zip(around, around[1:] + around[:1], strict=True)]
    return np.count_nonzero(sides, axis=0) > 2


def _gather(polygons: Any, part: Sides, count: int) -> tuple[Any, ...]:
    if np.array_equal(part, np.arange(count)):
        return tuple(polygons)
    order = np.argsort(part, kind="stable")
    pieces = np.split(polygons[order], np.searchsorted(part[order], np.arange(1, count)))
    return tuple(_geometry(piece) for piece in pieces)


def _geometry(pieces: Any) -> Any:
    if not len(pieces):
        return shapely.Polygon()
    return pieces[0] if len(pieces) == 1 else shapely.multipolygons(pieces)
