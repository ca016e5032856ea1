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
    marks, entries, taken, unwritten = list[Braille](), list[Entry](), shapely.Polygon(), list[str]()
    others = [text.content for text in texts]
    own = dict(zip(others, key_letters([*letters, *others])[len(letters) :], strict=True))
    if len(letters) + len(own) > len(LETTERS):  # pairs, as the parts then need not have
        own = dict.fromkeys(others, "")
    for text in texts:
        name = text.content
        at_mm = (
            sheet.left_mm + text.middle[0] * sheet.picture_mm[0],
            sheet.top_mm + text.middle[1] * sheet.picture_mm[1],
        )
        shape = min(free, key=lambda piece: piece.distance(shapely.Point(at_mm))).difference(taken)
        try:
            candidates = [(name, translate(name, language)), (own[name], translate(own[name], language))]
        except BrailleError:
            unwritten.append(name)
            continue
        places = ((says, place_text(cells, shape, at_mm)) for says, cells in candidates if cells)
        says, dots = next(((says, dots) for says, dots in places if dots is not None), ("", None))
        if dots is not None:
            marks.append(Braille(name if says == name else f"{says} {name}", dots))
            taken = shapely.union_all([taken, around(dots)])
        if says != name:
            entries.append(Entry(name, says, ""))
    if unwritten:
        note(log, f"texts without braille are left out: {first_labels(unwritten)}", logging.WARNING)
    if bare := [entry.name for entry in entries if not entry.letter]:
        note(log, f"the key alone has the texts {first_labels(bare)}")
    return marks, list(dict.fromkeys(entries))
