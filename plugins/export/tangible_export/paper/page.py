"""The pages of a work: the picture with its letters and fills, measured once it is drawn, and its key."""
# shapely has no types.
# pyright: reportUnknownVariableType=false, reportUnknownMemberType=false, reportUnknownArgumentType=false

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from jaxtyping import Float64

from tangible_core.data import PartMap, Work
from tangible_core.errors import PictureError
from tangible_core.errors import shown as shown_text
from tangible_core.parts import shared_borders
from tangible_core.plugins.notes import note

from ..braille import Cells, height_m, translate, written_by
from ..labels import some
from .colouring import coloured
from .fills import BLANK, KINDS, filled
from .key import Entry, key_pages
from .letters import around, placed
from .marks.gaps import Near, narrow_places, too_near
from .marks.reading import read
from .marks.svg import NO_DOTS, Area, Braille, Drawing, svg
from .named_parts import LETTERS, MOST_THINGS, Thing, key_letters, things_of
from .opening import opened_at
from .sheet import CLEAR_MM, GAP_MM, Page, Sheet
from .titles import title_at, title_lines
from .words import words

log = logging.getLogger(__name__)

SMOOTH_MM = 0.8
"""Tolerance of borders, by which the stairs of pixels become lines."""
ROUNDS = 6
"""Of measuring and putting right."""
APART_MM = 0.15
"""By which a letter is moved farther than it was too near."""


@dataclass(frozen=True)
class Shown:
    """A thing as it is shown."""

    thing: Thing
    letter: str
    cells: Cells
    """Of the letter."""
    kind: str
    """Of the fill."""


def drawn_pages(work: Work, parts: PartMap, sheet: Sheet, page: Page) -> list[str]:
    """The texts of SVGs: of the page itself, and of those of its key.

    Raises: PictureError for a picture of one part, or a page that cannot be read; BrailleError for its texts."""
    things = things_of(work, parts)
    if sum(len(thing.numbers) for thing in things) < 2:
        raise PictureError(
            "the picture is one part, and a page of it would be a frame and nothing in it; "
            "choose another texture method, say `parts:` by hand, or make smaller parts fit with `simplify:`"
        )
    if len(things) > MOST_THINGS:
        raise PictureError(
            f"{len(things)} parts are more than anybody keeps apart on a page, which takes {MOST_THINGS}; have "
            "fewer, by a texture method with fewer segments or by one name for several in `parts:`"
        )
    lines, whole = title_lines(work.title, work.language, sheet)
    sheet = sheet.below(1000 * height_m(len(lines)))
    if not whole:
        note(
            log, f"the title has more lines of braille than room above the picture: {len(lines)} of it, all in the key"
        )
    blank = Drawing(
        sheet=sheet,
        title=shown_text(work.title),
        description="",
        language=work.language,
        corner=words(work.language).corner,
        areas=(),
        texts=(title_at(work.title, lines),),
    )
    shown, picture = _smoothed(blank, parts, things)
    _say(shown, picture)
    keys = [_checked(key) for key in key_pages(_entries(shown, picture), work.title, work.language, page, sheet)]
    return [svg(picture), *keys]


def _smoothed(blank: Drawing, parts: PartMap, things: Sequence[Thing]) -> tuple[list[Shown], Drawing]:
    """The page, once no outlines run too near to each other: where they do, parts are opened.

    Raises: PictureError where that does not help.
    """
    near, sheet = list[Near](), blank.sheet
    wide_mm = sheet.picture_mm[0]
    for turn in range(ROUNDS):
        shapes = _on_page(parts, sheet)
        outlines = [Area(thing.name, shapes[number]) for thing in things for number in thing.numbers]
        if not (near := narrow_places(read(svg(replace(blank, areas=tuple(outlines), texts=()))))):
            shown = _shown(things, shapes, _beside(parts, things), blank.language)
            described = "; ".join(f"{each.letter} {each.thing.name}" for each in shown)
            drawing, near = _measured(replace(blank, description=described), shown, shapes)
            if not near:
                return shown, drawing
        parts = opened_at(parts, _on_picture([each.place_mm for each in near], sheet), wide_mm / 1000, turn + 1)
    raise PictureError(f"{near[0]}, and {GAP_MM} mm must be between them; make the picture larger or simpler")


def _on_picture(places_mm: Sequence[tuple[float, float]], sheet: Sheet) -> Float64[np.ndarray, "n 2"]:
    """Places on the page as shares of the picture's width, from its upper left corner."""
    return np.subtract(places_mm, (sheet.left_mm, sheet.top_mm)) / sheet.picture_mm[0]


def _on_page(parts: PartMap, sheet: Sheet) -> tuple[Any, ...]:
    """The shapes of parts in millimetres on the page, y down."""
    rows, columns = parts.labels.shape
    width, length = sheet.picture_mm
    middle = np.array([sheet.left_mm + width / 2, sheet.top_mm + length / 2])
    # The rows of a simplified map are whole, so its sides are those of the picture but for half a row.
    scale = np.array([width, -length * columns / rows])

    def moved(at: Float64[np.ndarray, "k 2"]) -> Float64[np.ndarray, "k 2"]:
        return at * scale + middle

    shapes = shared_borders(parts, 1.0, SMOOTH_MM / width)
    return tuple(shapely.transform(each, moved) for each in shapes)


def _beside(parts: PartMap, things: Sequence[Thing]) -> list[set[int]]:
    """The things that share a border with each."""
    of = np.zeros(parts.count, np.int64)
    for place, thing in enumerate(things):
        of[list(thing.numbers)] = place
    labels = of[parts.labels]
    found = [set[int]() for _ in things]
    for one, other in ((labels[:, 1:], labels[:, :-1]), (labels[1:], labels[:-1])):
        for pair in np.unique(np.stack([one[one != other], other[one != other]]), axis=1).T.tolist():
            found[pair[0]].add(pair[1])
            found[pair[1]].add(pair[0])
    return found


def _shown(things: Sequence[Thing], shapes: Sequence[Any], beside: list[set[int]], language: str) -> list[Shown]:
    letters = key_letters([thing.name for thing in things])
    plain = [
        Shown(thing, letter, translate(letter, language), BLANK) for thing, letter in zip(things, letters, strict=True)
    ]
    allowed = [
        [kind for kind in KINDS if kind == BLANK or _has_room(replace(each, kind=kind), shapes)] for each in plain
    ]
    sizes = [sum(shapes[number].area for number in thing.numbers) for thing in things]
    kinds, alike = coloured(beside, allowed, sizes)
    shown = [replace(each, kind=kind) for each, kind in zip(plain, kinds, strict=True)]
    if alike:
        pairs = [f"{things[one].name} and {things[other].name}" for one, other in alike]
        note(log, f"neighbours with one fill, for want of another: {some(pairs)}", logging.WARNING)
    if len(things) > len(LETTERS):
        note(
            log,
            f"{len(things)} parts have letters, two each: many for one page; fewer are read sooner",
            logging.WARNING,
        )
    return shown


def _has_room(each: Shown, shapes: Sequence[Any]) -> bool:
    """Whether the largest part of the thing can have this fill."""
    largest = max(each.thing.numbers, key=lambda number: shapes[number].area)
    return bool(_area(each, shapes[largest]).fill)


def _area(each: Shown, shape: Any, clear_mm: float = CLEAR_MM) -> Area:
    """clear_mm: kept around the letter; infinite where it is left out."""
    dots = placed(each.cells, shape, clear_mm) if clear_mm < np.inf else None
    fill = filled(shape, each.kind, None if dots is None else around(dots))
    return Area(each.thing.name, shape, fill, None if dots is None else Braille(each.letter, dots))


def _measured(blank: Drawing, shown: Sequence[Shown], shapes: Sequence[Any]) -> tuple[Drawing, list[Near]]:
    """The page, once nothing on it is too near to anything: letters are moved or left out, elements of fills left out.

    And what that does not help.
    """
    pieces = [(each, shapes[number]) for each in shown for number in each.thing.numbers]
    away, clear_mm = NO_DOTS, [CLEAR_MM] * len(pieces)
    drawing, near = blank, list[Near]()
    for turn in range(ROUNDS):
        areas = [_area(each, shape, clear) for (each, shape), clear in zip(pieces, clear_mm, strict=True)]
        areas = [replace(area, fill=area.fill.without(away)) if len(away) else area for area in areas]
        drawing = replace(blank, areas=tuple(areas))
        near = too_near(read(svg(drawing)))
        if not near or any(each.between_outlines for each in near):
            return drawing, [each for each in near if each.between_outlines]
        for each in near:
            if fills := [mark.place_mm for mark in each.marks if mark.what == "fill"]:
                away = np.concatenate([away, fills[-1:]])
            elif (number := _letter_in(each, areas)) is None:
                return drawing, [each]
            else:
                clear_mm[number] = clear_mm[number] + GAP_MM - each.gap_mm + APART_MM if turn < 2 else np.inf
    return drawing, near


def _letter_in(near: Near, areas: Sequence[Area]) -> int | None:
    """The area whose letter is too near to something."""
    at = shapely.points(np.array([mark.place_mm for mark in near.marks if mark.what == "braille"]).reshape(-1, 2))
    for number, area in enumerate(areas):
        if area.letter is not None and (shapely.distance(shapely.MultiPoint(area.letter.dots_mm), at) < 0.1).any():
            return number
    return None


def _checked(key: Drawing) -> str:
    """Raises: PictureError if something in it is too near to something."""
    text = svg(key)
    if near := too_near(read(text)):
        raise PictureError(f"in the key, {near[0]}, and {GAP_MM} mm must be between them")
    return text


def _entries(shown: Sequence[Shown], picture: Drawing) -> list[Entry]:
    """What the key says: of letters and fills those that are on the page."""
    lettered = {area.label for area in picture.areas if area.letter}
    has_fill = {area.label for area in picture.areas if area.fill}
    return [
        Entry(
            each.thing.name,
            each.letter if each.thing.name in lettered else "",
            each.kind if each.thing.name in has_fill else BLANK,
        )
        for each in shown
    ]


def _say(shown: Sequence[Shown], picture: Drawing) -> None:
    """What the page leaves out, by the names of the parts."""
    note(log, f"braille by {written_by(picture.language)}")
    if bare := [area.label for area in picture.areas if area.letter is None]:
        note(log, f"no room for a letter in {some(bare)}")
    kinds = {each.thing.name: each.kind for each in shown}
    if bare := [area.label for area in picture.areas if kinds[area.label] != BLANK and not area.fill]:
        note(log, f"no room for a fill in {some(bare)}")
