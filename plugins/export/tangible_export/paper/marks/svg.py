"""The SVG of a page: explicit black shapes alone."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np
import shapely
from jaxtyping import Float64

from ...braille import DOT_DIAMETER_M
from ..fills import DOT_MM as FILL_DOT_MM
from ..fills import Fill
from ..sheet import CORNER_MM, DOT_MM, HEAVY_MM, LINE_MM, MARGIN_MM, Sheet

BLACK = "#000"
BRAILLE_DOT_MM = 1000 * DOT_DIAMETER_M
NO_DOTS = np.zeros((0, 2))


@dataclass(frozen=True)
class Braille:
    """A text in braille: its dots in millimetres on the page."""

    text: str
    dots_mm: Float64[np.ndarray, "n 2"]


@dataclass(frozen=True)
class Area:
    """A shape with an outline, perhaps with a fill and a letter."""

    label: str
    outline: Any
    fill: Fill = field(default_factory=Fill)
    letter: Braille | None = None


@dataclass(frozen=True)
class Drawing:
    """A page; its corner mark is drawn with it."""

    sheet: Sheet
    title: str
    description: str
    language: str
    corner: str
    areas: tuple[Area, ...]
    texts: tuple[Braille, ...]
    figure: Any = None
    """The shape of the figure, whose outline is heavier; None without one."""
    strokes: tuple[Any, ...] = ()
    """The lines of the picture, and as points the dots of dotted ones."""


def svg(drawing: Drawing, colour: str = BLACK, over: Sequence[str] = ()) -> str:
    """Return the text of the file, whose `data-mark` has a mark's role, with the elements `over` over the marks."""
    sheet = drawing.sheet
    language = quoteattr(drawing.language.partition("-x-")[0])  # without the grade of the braille
    paint = "" if colour == BLACK else f'fill="{colour}" '
    width, length = f"{sheet.width_mm:g}", f"{sheet.length_mm:g}"
    lines = [
        f'<svg {paint}xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{length}mm" '
        f'viewBox="0 0 {width} {length}" lang={language} xml:lang={language} '
        'role="graphics-document document" aria-labelledby="title" aria-describedby="description">',
        f'<title id="title">{escape(drawing.title)}</title>',
        f'<desc id="description">{escape(drawing.description)}</desc>',
        *(_braille(text) for text in drawing.texts),
        _corner(drawing),
        *(_area(area, colour) for area in drawing.areas),
        *([] if drawing.figure is None else [_outline(drawing.figure, colour, HEAVY_MM)]),
        *_strokes(drawing.strokes, colour),
        *over,
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def _corner(drawing: Drawing) -> str:
    right, top = drawing.sheet.width_mm - MARGIN_MM, MARGIN_MM
    corner = np.array([(right - CORNER_MM, top), (right, top), (right, top + CORNER_MM)])
    return f'<path data-mark="corner" role="img" aria-label={quoteattr(drawing.corner)} d="{_line(corner)}Z"/>'


def _area(area: Area, colour: str) -> str:
    inside = [_outline(area.outline, colour, LINE_MM)]
    inside += [_braille(area.letter)] if area.letter else []
    inside += [_fill(area.fill, colour)] if area.fill else []
    return "\n".join([f'<g role="img" aria-label={quoteattr(area.label)}>', *inside, "</g>"])


def _outline(shape: Any, colour: str, width_mm: float) -> str:
    rings = shapely.get_rings(shapely.get_parts(shape))
    line = "".join(f"{_line(shapely.get_coordinates(ring)[:-1])}Z" for ring in rings)
    return (
        f'<path data-mark="outline" fill="none" stroke="{colour}" stroke-width="{width_mm:g}" stroke-linejoin="round" '
        f'd="{line}"/>'
    )


def _strokes(strokes: Iterable[Any], colour: str) -> Iterable[str]:
    dots = [shapely.get_coordinates(stroke)[0] for stroke in strokes if stroke.geom_type == "Point"]
    if dots:
        yield f'<g data-mark="line">{_discs(dots, DOT_MM)}</g>'
    if lines := "".join(_line(shapely.get_coordinates(each)) for each in strokes if each.geom_type != "Point"):
        yield (
            f'<path data-mark="line" fill="none" stroke="{colour}" stroke-width="{LINE_MM:g}" stroke-linecap="round" '
            f'stroke-linejoin="round" d="{lines}"/>'
        )


def _fill(fill: Fill, colour: str) -> str:
    strokes = "".join(_line(shapely.get_coordinates(stroke)) for stroke in fill.strokes)
    if not strokes:
        return f'<g data-mark="fill">{_discs(fill.dots_mm, FILL_DOT_MM)}</g>'
    return (
        f'<path data-mark="fill" fill="none" stroke="{colour}" stroke-width="{fill.stroke_mm:g}" '
        f'stroke-linecap="round" stroke-linejoin="round" d="{strokes}"/>'
    )


def _braille(text: Braille) -> str:
    discs = _discs(text.dots_mm, BRAILLE_DOT_MM)
    return f'<g data-mark="braille" role="img" aria-label={quoteattr(text.text)}>{discs}</g>'


def _discs(at_mm: Iterable[Float64[np.ndarray, " 2"]], diameter_mm: float) -> str:
    return "".join(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{diameter_mm / 2:.2f}"/>' for x, y in at_mm)


def _line(at_mm: Float64[np.ndarray, "n 2"]) -> str:
    return "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in at_mm)
