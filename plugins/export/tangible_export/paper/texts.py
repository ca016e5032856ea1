"""The texts of a picture on its page: in braille at their places, or a letter there and a line of the key."""

import logging
from collections.abc import Collection, Sequence
from typing import Any

import shapely

from tangible_core.data import PictureText
from tangible_core.errors import BrailleError
from tangible_core.plugins import note

from ..braille import translate
from .key import Entry
from .lettering import around, place_text
from .marks.svg import Braille
from .named_parts import LETTERS, first_labels, key_letters
from .sheet import Sheet

log: logging.Logger = logging.getLogger(__name__)


def picture_box(sheet: Sheet) -> Any:
    """Return the rectangle of the picture on a page, in millimetres."""
    width, length = sheet.picture_mm
    return shapely.box(sheet.left_mm, sheet.top_mm, sheet.left_mm + width, sheet.top_mm + length)


def place_texts(
    texts: Sequence[PictureText], letters: Collection[str], free: Sequence[Any], sheet: Sheet, language: str
) -> tuple[list[Braille], list[Entry]]:
    """Return the marks of texts on a page, and the lines of the key for those that have no room as they are.

    letters: those that parts have. free: the shapes without their marks, of which a text stays in its own.
    """
    marks, entries, taken, unwritten = list[Braille](), dict[Entry, None](), shapely.Polygon(), list[str]()
    names = [*letters, *(text.content for text in texts)]
    own = (
        dict(zip(names, key_letters(names), strict=True)) if len(names) <= len(LETTERS) else {}
    )  # pairs are no letters
    (left, top, *_), size = picture_box(sheet).bounds, sheet.picture_mm
    for name, (x, y) in [(text.content, text.middle) for text in texts]:
        at_mm = left + x * size[0], top + y * size[1]
        shape = min(free, key=lambda piece: piece.distance(shapely.Point(at_mm))).difference(taken)
        try:
            whole, letter = translate(name, language), translate(own.get(name, ""), language)
        except BrailleError:
            unwritten.append(name)
            continue
        dots, says = place_text(whole, shape, at_mm), name
        if dots is None:
            dots, says = place_text(letter, shape, at_mm) if letter else None, f"{own.get(name)} {name}"
            entries[Entry(name, "" if dots is None else own[name], "")] = None
        if dots is not None:
            marks.append(Braille(says, dots))
            taken = shapely.union_all([taken, around(dots)])
    if unwritten:
        note(log, f"texts without braille are left out: {first_labels(unwritten)}", logging.WARNING)
    if bare := [entry.name for entry in entries if not entry.letter]:
        note(log, f"the key alone has the texts {first_labels(bare)}")
    return marks, [*entries]
