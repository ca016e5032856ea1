"""Copies of pages in ink, for a teacher who reads no braille: the marks in grey, their texts and a scale in black."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.sax.saxutils import escape

import matplotlib as mpl
import numpy as np
import shapely
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...braille import visible
from ..sheet import MARGIN_MM
from .reading import read
from .rendering import POINTS_PER_MM, make_figure, save_pdf
from .svg import Area, Braille, Drawing, svg

GREY = "#999999"
LETTERS_MM = 4.0  # as large as print in a book for children
ABOVE_MM = 2.4
SCALE_MM = MARGIN_MM, MARGIN_MM + 50.0
SCALE = "5 cm"
WIDE = 0.56


@dataclass(frozen=True)
class Label:
    """A text in ink; its place is the left end, or the middle, of its base line, in millimetres on the page."""

    text: str
    x_mm: float
    y_mm: float
    middle: bool = False


def ink_svg(drawing: Drawing, note: str, named: bool) -> str:
    """Return a page in ink as SVG. note: a sentence at its foot. named: True if its areas are parts, with names."""
    y, (left, right) = _foot_mm(drawing), SCALE_MM
    bar = f'<path data-mark="scale" stroke="#000" stroke-width="0.5" d="M{left:g} {y:g}L{right:g} {y:g}"/>'
    return svg(drawing, GREY, [bar, *map(_text, labels(drawing, note, named))])


def write_ink_pdf(path: Path, pages: Sequence[Drawing], note: str) -> None:
    """Write all pages in ink: the first one with the names of its parts, the others, a key, with their own texts."""
    figures = [_figure(page, note, number == 0) for number, page in enumerate(pages)]
    with mpl.rc_context({"pdf.fonttype": 42}):  # so that the names can be searched and copied
        save_pdf(path, pages[0].title, figures)


def labels(drawing: Drawing, note: str, named: bool) -> list[Label]:
    """Return the texts of a page in ink: those of its braille, the names of its parts, the scale and the note."""
    foot, (_, right) = _foot_mm(drawing) + LETTERS_MM / 3, SCALE_MM
    texts = [_above(text) for text in drawing.texts if len(text.dots_mm)]
    texts += [_at_part(area, drawing.sheet.width_mm) for area in _one_of_each(drawing.areas)] if named else []
    texts = [replace(label, text=visible(label.text)) for label in texts]  # a font has nothing for what cannot be seen
    return [*texts, Label(SCALE, right + 2, foot), Label(note, right + 20, foot)]


def _above(text: Braille) -> Label:
    left, top = text.dots_mm.min(axis=0)
    return Label(text.text, float(left), float(top) - ABOVE_MM)


def _one_of_each(areas: Sequence[Area]) -> Iterator[Area]:
    """Yield each area but those that have no letter and share their name with one that has: one word is enough."""
    with_letter = {area.label for area in areas if area.letter is not None}
    yield from (area for area in areas if area.letter is not None or area.label not in with_letter)


def _at_part(area: Area, width_mm: float) -> Label:
    """Return the letter and the name of a part, below its letter in braille, or in its middle."""
    if area.letter is None:
        x, y = shapely.get_coordinates(shapely.maximum_inscribed_circle(area.outline, tolerance=0.5))[0]
        text = area.label
    else:
        x, y = area.letter.dots_mm.mean(axis=0)[0], area.letter.dots_mm[:, 1].max() + ABOVE_MM + LETTERS_MM
        text = f"{area.letter.text} {area.label}"
    half = WIDE * LETTERS_MM * len(text) / 2
    return Label(text, float(np.clip(x, 2 + half, max(2 + half, width_mm - 2 - half))), float(y), middle=True)


def _foot_mm(drawing: Drawing) -> float:
    return drawing.sheet.length_mm - MARGIN_MM / 2


def _text(label: Label) -> str:
    anchor = ' text-anchor="middle"' if label.middle else ""
    return (
        f'<text x="{label.x_mm:.2f}" y="{label.y_mm:.2f}" font-family="sans-serif" font-size="{LETTERS_MM:g}"{anchor} '
        f'fill="#000" stroke="#fff" stroke-width="0.9" stroke-linejoin="round" paint-order="stroke">'
        f"{escape(label.text)}</text>"
    )


def _figure(drawing: Drawing, note: str, named: bool) -> Figure:
    page = read(svg(drawing))
    width, length = page.size_mm
    figure = make_figure(page, page.marks, colour=GREY)
    y = 1 - _foot_mm(drawing) / length
    ends = [end / width for end in SCALE_MM]
    figure.add_artist(Line2D(ends, [y, y], color="black", linewidth=0.5 * POINTS_PER_MM, transform=figure.transFigure))
    for label in labels(drawing, note, named):
        figure.text(
            label.x_mm / width,
            1 - label.y_mm / length,
            label.text,
            fontsize=LETTERS_MM * POINTS_PER_MM,
            ha="center" if label.middle else "left",
            parse_math=False,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.3 * POINTS_PER_MM},
        )
    return figure
