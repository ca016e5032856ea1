"""Braille on a page: the title, lines of text, and letters in parts, clear of the outlines."""

from typing import Any, NamedTuple

import numpy as np
import shapely
from jaxtyping import Float64

from ..braille import DOT_DIAMETER_M, LINE_PITCH_M, Cells, dots, wrapped
from .marks.svg import BRAILLE_DOT_MM, Braille
from .sheet import CLEAR_MM, LINE_MM, MARGIN_MM, Sheet

MAX_TITLE_LINES = 4
FREE_MM = 5.0
"""Distance between a letter and a fill: larger than between other marks, or the dots of a fill are read as part of the
letter. A convention of ours."""


FAR_MM = 12.0  # the farthest from its place that a text of the picture is written. A convention of ours


class Words(NamedTuple):
    """The words of a page that are not names, in one language."""

    key: str
    corner: str
    ink: str


WORDS = {
    "en": Words("key", "upper right corner", "Copy in ink, to read by eye: do not put it through the heater."),
    "de": Words("Legende", "Ecke oben rechts", "Schwarzschriftkopie für Sehende: nicht schwellen."),
    "fr": Words("légende", "coin supérieur droit", "Copie en noir pour les voyants : ne pas chauffer."),
}


def words(language: str) -> Words:
    """Return the words for a language tag such as `de-AT`; English if there are none."""
    return WORDS.get(language.partition("-")[0].lower(), WORDS["en"])


def title_lines(title: str, language: str, sheet: Sheet) -> tuple[list[Cells], bool]:
    """Return the lines with room above the picture, and whether these are all. Raises: BrailleError as `wrapped`."""
    lines = wrapped(title, language, sheet.title_width_mm / 1000)
    room = 1 + int((sheet.spare_mm / 1000 + 1e-9) / LINE_PITCH_M)
    return lines[:room], len(lines) <= room


def title_at(title: str, lines: list[Cells]) -> Braille:
    """Place a title in the upper left corner of a sheet."""
    return lines_at(title, lines, MARGIN_MM, MARGIN_MM)


def lines_at(text: str, lines: list[Cells], left_mm: float, top_mm: float) -> Braille:
    """Place lines of braille whose dots begin at this left and upper edge."""
    edge_m = DOT_DIAMETER_M / 2
    at = [dots(line, (edge_m, edge_m + row * LINE_PITCH_M)) for row, line in enumerate(lines)]
    return Braille(text, 1000 * np.concatenate([*at, np.zeros((0, 2))]) + np.array([left_mm, top_mm]))


def place_letter(cells: Cells, shape: Any, clear_mm: float = CLEAR_MM) -> Float64[np.ndarray, "n 2"] | None:
    """Return the dots of a letter in a shape, in millimetres, each clear of the outline; None without room."""
    offsets = 1000 * dots(cells)
    parts = shapely.get_parts(_room(offsets, shape, clear_mm))
    pieces = [piece for piece in parts if piece.geom_type == "Polygon" and piece.area > 0]
    if not pieces:
        return None
    radii = [shapely.maximum_inscribed_circle(piece, tolerance=0.1) for piece in pieces]
    best = max(radii, key=lambda circle: circle.length)
    return offsets + np.array(best.coords[0])


def place_text(
    cells: Cells, shape: Any, at_mm: tuple[float, float], far_mm: float = FAR_MM
) -> Float64[np.ndarray, "n 2"] | None:
    """Return the dots of a text in a shape with their middle next to a place; None without room up to `far_mm`."""
    offsets, whole = 1000 * dots(cells), 1000 * dots((0b111111,) * len(cells))  # no line runs through a space
    middle = whole.mean(axis=0)
    room = _room(whole - middle, shape, CLEAR_MM)
    if room.is_empty or room.distance(shapely.Point(at_mm)) > far_mm:
        return None
    return offsets - middle + shapely.get_coordinates(shapely.shortest_line(room, shapely.Point(at_mm)))[0]


def _room(offsets: Float64[np.ndarray, "n 2"], shape: Any, clear_mm: float) -> Any:
    """Return the places for the first dot: the shrunk shape, moved back by the offset of each dot, intersected."""
    clear = shape.buffer(-(LINE_MM / 2 + clear_mm + BRAILLE_DOT_MM / 2))
    return shapely.intersection_all([_move(clear, -offset) for offset in offsets])


def around(dots_mm: Float64[np.ndarray, "n 2"]) -> Any:
    """Return the area around a letter that fills leave free: around its convex hull, as it is read as one shape."""
    return shapely.MultiPoint(dots_mm).convex_hull.buffer(BRAILLE_DOT_MM / 2 + FREE_MM)


def _move(shape: Any, by: Float64[np.ndarray, " 2"]) -> Any:
    return shapely.transform(shape, lambda at: at + by)
