"""Where in a part its letter stands: clear of the outline, as far from it as can be."""
# shapely has no types.
# pyright: reportUnknownVariableType=false, reportUnknownMemberType=false, reportUnknownArgumentType=false

from typing import Any

import numpy as np
import shapely
from jaxtyping import Float64

from ..braille import DOT_DIAMETER_M, Cells, dots
from .sheet import CLEAR_MM, LINE_MM

DOT_MM = 1000 * DOT_DIAMETER_M
FREE_MM = 5.0
"""Between a letter and a fill: more than between other marks, or the dots of a fill are read along. A convention of
ours."""


def placed(cells: Cells, shape: Any, clear_mm: float = CLEAR_MM) -> Float64[np.ndarray, "n 2"] | None:
    """The dots of a letter within a shape, in millimetres on the page; None where there is no room.

    Where each dot is clear of the outline, the first of the letter has all places of which the shape, shrunk, holds
    those of all its dots: the intersection of as many copies of it. In that the point farthest from its edge is taken.
    """
    clear = shape.buffer(-(LINE_MM / 2 + clear_mm + DOT_MM / 2))
    offsets = 1000 * dots(cells)
    room = shapely.intersection_all([_moved(clear, -each) for each in offsets])
    pieces = [each for each in shapely.get_parts(room) if each.geom_type == "Polygon" and each.area > 0]
    if not pieces:
        return None
    radii = [shapely.maximum_inscribed_circle(each, tolerance=0.1) for each in pieces]
    best = max(radii, key=lambda each: each.length)
    return offsets + np.array(best.coords[0])


def around(dots_mm: Float64[np.ndarray, "n 2"]) -> Any:
    """What stays free of fills around a letter: not around its dots alone, for the shape of the whole is read."""
    return shapely.MultiPoint(dots_mm).convex_hull.buffer(DOT_MM / 2 + FREE_MM)


def _moved(shape: Any, by: Float64[np.ndarray, " 2"]) -> Any:
    return shapely.transform(shape, lambda at: at + by)
