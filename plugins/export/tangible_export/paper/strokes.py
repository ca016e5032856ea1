"""The lines of a drawing as strokes of one width on a page."""
# shapely has no types.
# pyright: reportUnknownVariableType=false, reportUnknownMemberType=false, reportUnknownArgumentType=false

from typing import Any

import numpy as np
import shapely
from jaxtyping import Bool, Float64

from tangible_core.drawing import find_marks

from .sheet import LINE_MM, Sheet
from .smoothing import NEAR_MM, blur

SPUR_MM = 3.0  # a shorter stroke with a free end is a spur of the thinning. A convention of ours
SMOOTH_PX = 2.0  # standard deviation of the Gaussian along a stroke, which takes the stairs of pixels out
# Distance and length over which a stroke that runs along an outline is left out, as the outline stands for it.
ALONG_MM, LONG_MM = 2.0, 6.0


def strokes_on(picture: np.ndarray, sheet: Sheet, outlines: Any = None) -> tuple[Any, ...]:
    """Return a drawing's strokes, in millimetres and apart from `outlines`."""
    centre = find_marks(picture).lines.centre
    rows, columns = centre.shape
    to_mm = np.divide(sheet.picture_mm, (columns, rows))
    lines = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(_links(centre))))
    ends = shapely.get_coordinates([(line.boundary) for line in lines])
    places, uses = np.unique(ends, axis=0, return_counts=True)
    free = {tuple(place) for place, count in zip(places.tolist(), uses.tolist(), strict=True) if count == 1}
    strokes = list[Any]()
    for line in lines:
        at = shapely.get_coordinates(line)
        stroke = _smooth((at + 0.5) * to_mm + (sheet.left_mm, sheet.top_mm), bool(line.is_closed))
        alone = line.is_closed or (tuple(at[0]) in free and tuple(at[-1]) in free)
        if alone or stroke.length >= SPUR_MM or not {tuple(at[0]), tuple(at[-1])} & free:
            strokes.append(stroke)
    if outlines is not None and strokes:
        strokes = _apart(strokes, outlines)
    return tuple(strokes)


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
