"""The lines of a drawing as strokes of one width on a page, dashed and dotted ones as dashes and dots."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from jaxtyping import Bool, Float64
from shapely.ops import substring

from tangible_core.drawing import find_marks

from .sheet import CLEAR_MM, DASH_MM, DOT_MM, LINE_MM, Sheet
from .smoothing import NEAR_MM, blur

SPUR_MM = 3.0  # a shorter stroke with a free end is a spur of the thinning. A convention of ours
SMOOTH_PX = 2.0  # standard deviation of the Gaussian along a stroke, which takes the stairs of pixels out
# Distance and length over which a stroke that runs along an outline is left out, as the outline stands for it.
ALONG_MM, LONG_MM = 2.0, 6.0


def strokes_on(picture: np.ndarray, sheet: Sheet, outlines: Any = None) -> tuple[Any, ...]:
    """Return a drawing's strokes and the dots of dotted ones, in millimetres and apart from `outlines`."""
    lines_drawn = find_marks(picture).lines
    rows, columns = lines_drawn.solid.shape

    def to_page(at: Float64[np.ndarray, "n 2"], closed: bool) -> Any:
        to_mm = np.divide(sheet.picture_mm, (columns, rows))
        return _smooth((at + 0.5) * to_mm + (sheet.left_mm, sheet.top_mm), closed)

    lines = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(_links(lines_drawn.solid))))
    ends = shapely.get_coordinates([(line.boundary) for line in lines])
    places, uses = np.unique(ends, axis=0, return_counts=True)
    free = {tuple(place) for place, count in zip(places.tolist(), uses.tolist(), strict=True) if count == 1}
    strokes = list[Any]()
    for line in lines:
        at = shapely.get_coordinates(line)
        stroke = to_page(at, bool(line.is_closed))
        alone = line.is_closed or (tuple(at[0]) in free and tuple(at[-1]) in free)
        if alone or stroke.length >= SPUR_MM or not {tuple(at[0]), tuple(at[-1])} & free:
            strokes.append(stroke)
    outlines = shapely.LineString() if outlines is None else outlines
    ways = [to_page(line.way, bool(np.allclose(line.way[0], line.way[-1]))) for line in lines_drawn.dashed]
    along = shapely.union_all(ways).buffer(LINE_MM)  # with dashes that touch a line
    apart = [stroke for stroke in _apart(strokes, outlines) if not stroke.within(along)]
    strokes = [*shapely.get_parts(shapely.line_merge(shapely.MultiLineString(apart)))]
    # A dashed line keeps clear of those that it meets, so that a finger can follow these.
    solid = shapely.union_all([*strokes, outlines]).buffer(LINE_MM)
    for line, way in zip(lines_drawn.dashed, ways, strict=True):
        met = way.intersection(solid).buffer(CLEAR_MM + DOT_MM / 2)
        for piece in _apart([way], outlines):
            rest = shapely.difference(_dashes(piece, sorted(line.dots)), met)
            strokes += [dash for dash in shapely.get_parts(rest) if not dash.is_empty]
    return tuple(strokes)


def _dashes(way: Any, dots: Sequence[bool]) -> list[Any]:
    """Return dashes and dots along a line, from end to end. dots: whether each of a period is a dot, in turn."""
    half, length = np.where(dots, DOT_MM, LINE_MM) / 2, np.where(dots, 0, DASH_MM - LINE_MM)
    steps, last = length + CLEAR_MM + half + np.roll(half, -1), 0 if way.is_closed else length[0]
    count = max(int((way.length - last) / steps.sum()), int(way.is_closed))
    starts = np.concatenate([[0], np.cumsum(np.tile(steps, count))])[: -1 if way.is_closed else None]
    stretch = way.length / max(count * steps.sum() + last, NEAR_MM)
    ends = starts + np.resize(length, starts.size)
    return [substring(way, *(stretch * cut)) for cut in np.stack([starts, ends], axis=1)]


def _links(centre: Bool[np.ndarray, "r c"]) -> Float64[np.ndarray, "n 2 2"]:
    """Return the pairs of neighbouring pixels; diagonal ones where no straight step leads from one to the other."""
    whole, links = np.pad(centre, 1), list[np.ndarray]()
    rows, columns = np.nonzero(centre)
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        mask = whole[rows + 1 + down, columns + 1 + right]
        if down and right:
            mask &= ~(whole[rows + 2, columns + 1] | whole[rows + 1, columns + 1 + right])
        one = np.stack([columns[mask], rows[mask]], axis=1)
        links.append(np.stack([one, one + np.array([right, down])], axis=1))
    return np.concatenate(links).astype(np.float64)


def _smooth(at: Float64[np.ndarray, "n 2"], closed: bool) -> Any:
    smooth = blur(at[:-1] if closed else at, SMOOTH_PX, closed)
    smooth = np.concatenate([smooth, smooth[:1]]) if closed else smooth
    smooth[[0, -1]] = smooth[[0, -1]] if closed else at[[0, -1]]
    return shapely.simplify(shapely.linestrings(smooth), NEAR_MM)


def _apart(strokes: list[Any], outlines: Any) -> list[Any]:
    """Return the strokes without what runs along an outline; what only crosses or meets one stays."""
    near, remaining = outlines.buffer(ALONG_MM), list[Any]()
    for stroke in strokes:
        along = [piece for piece in shapely.get_parts(stroke.intersection(near)) if piece.length > LONG_MM]
        rest = shapely.get_parts(stroke.difference(shapely.union_all(along).buffer(LINE_MM / 10)) if along else stroke)
        remaining += [
            piece for piece in rest if piece.geom_type == "LineString" and (not along or piece.length > SPUR_MM)
        ]
    return remaining
