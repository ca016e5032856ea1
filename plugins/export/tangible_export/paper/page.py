"""The pages of a work: the picture with its letters and fills, measured after it is drawn, and its key."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from jaxtyping import Float64

from tangible_core.data import Figure, PartMap, PictureText, Work
from tangible_core.errors import PictureError
from tangible_core.errors import shown as shown_text
from tangible_core.plugins import note
from tangible_legibility.words.languages import part_label

from ..braille import Cells, height_m, title_in_braille, translate, written_by
from .colouring import choose_fills
from .fills import BLANK, KINDS, fill_shape
from .key import Entry, key_pages
from .lettering import around, place_letter, title_at, title_lines, words
from .marks.gaps import Near, narrow_places, too_near
from .marks.reading import read
from .marks.svg import NO_DOTS, Area, Braille, Drawing, svg
from .named_parts import LETTERS, MAX_NAMES, NamedParts, first_labels, group_by_name, key_letters
from .opening import open_at
from .sheet import CLEAR_MM, DOT_MM, GAP_MM, Page, Sheet
from .smoothing import smooth_borders
from .strokes import strokes_on
from .texts import picture_box, place_texts

log: logging.Logger = logging.getLogger(__name__)

ROUNDS = 6
APART_MM = 0.15  # added when a letter is moved away from a mark


@dataclass(frozen=True)
class Symbols:
    """The letter and the fill by which the parts of one name are shown."""

    group: NamedParts
    letter: str
    cells: Cells
    kind: str
    is_paper: bool = False


def drawn_pages(work: Work, parts: PartMap, sheet: Sheet, page: Page) -> list[Drawing]:
    """Return the page and its key. Raises: PictureError if fingers cannot read it; BrailleError for its texts."""
    groups = group_by_name(work, parts)
    if sum(len(group.numbers) for group in groups) < 2:
        raise PictureError(
            "the picture is one part, and its page would be an empty frame; "
            "choose another texture method, give `parts:` by hand, or make smaller parts fit with `simplify:`"
        )
    if len(groups) > MAX_NAMES:
        raise PictureError(
            f"{len(groups)} parts are more than anybody can tell apart on a page, which takes {MAX_NAMES}; have "
            "fewer, by a texture method with fewer segments or by one name for several in `parts:`"
        )
    blank, title = _blank_page(work, sheet)
    drawing = work.picture if work.kind in ("drawing", "lines") else None
    texts = [text for text in work.texts if text.content]
    figure: Figure = work.extras.get("figure") or Figure()
    symbols, picture, entries = _draw_readable(blank, parts, groups, figure.front_parts(parts), drawing, texts)
    _note_left_out(symbols, picture)
    return [picture, *_keys([*_entries(symbols, picture), *entries], title, work.language, page, blank.sheet)]


def _keys(entries: list[Entry], title: str, language: str, page: Page, like: Sheet) -> list[Drawing]:
    keys = key_pages(entries, title, language, page, like)
    for key in keys:
        if near := too_near(read(svg(key))):
            raise PictureError(f"in the key, {near[0]}, and {GAP_MM} mm must be between them")
    return keys


def drawn_lines(work: Work, picture: np.ndarray, sheet: Sheet, page: Page) -> list[Drawing]:
    """Return a drawing's page, and its key if it has one. Raises: PictureError without lines; BrailleError."""
    blank, title = _blank_page(work, sheet)
    strokes = strokes_on(picture, blank.sheet)
    if not strokes:
        raise PictureError("the drawing has no lines; give `scene: {kind: photograph}` to outline its parts")
    inked = shapely.union_all(strokes).buffer(DOT_MM / 2)
    texts = [text for text in work.texts if text.content]
    marks, entries = place_texts(texts, (), [picture_box(blank.sheet).difference(inked)], blank.sheet, work.language)
    drawing = replace(blank, description=shown_text(work.title), strokes=strokes, texts=(*blank.texts, *marks))
    return [drawing, *(_keys(entries, title, work.language, page, blank.sheet) if entries else ())]


def _blank_page(work: Work, sheet: Sheet) -> tuple[Drawing, str]:
    title = title_in_braille(work.title, work.language)
    lines, whole = title_lines(title, work.language, sheet)
    if not whole:
        note(log, f"only {len(lines)} lines of the title's braille have room above the picture; the key has all")
    blank = Drawing(
        sheet=sheet.below(1000 * height_m(len(lines))),
        title=shown_text(work.title),
        description="",
        language=work.language,
        corner=words(work.language).corner,
        areas=(),
        texts=(title_at(title, lines),),
    )
    return blank, title


def _draw_readable(
    blank: Drawing,
    parts: PartMap,
    groups: Sequence[NamedParts],
    front: Sequence[int],
    drawn: np.ndarray | None,
    texts: Sequence[PictureText],
) -> tuple[list[Symbols], Drawing, list[Entry]]:
    """Draw the page; open the parts where their outlines run too near to each other, until none do.

    front: numbers of the parts of the figure, whose common outline is heavier if that has room. drawn: the picture of a
    flat drawing, whose lines are drawn as well, and whose paper stays empty; None for another. texts: of the picture.
    Returns also the texts that only the key has.
    Raises: PictureError if that does not help.
    """
    near, sheet, original = list[Near](), blank.sheet, parts
    wide_mm = sheet.picture_mm[0]
    for turn in range(ROUNDS):
        shapes = _on_page(parts, sheet)
        blank = replace(blank, figure=shapely.union_all([shapes[number] for number in front]) if front else None)
        outlines = [Area(group.name, shapes[number]) for group in groups for number in group.numbers]
        if not (near := narrow_places(read(svg(replace(blank, areas=tuple(outlines), texts=()))))):
            lines = None if drawn is None else shapely.union_all([shape.boundary for shape in shapes])
            strokes = () if drawn is None else strokes_on(drawn, sheet, lines)
            symbols = _choose_symbols(groups, shapes, _neighbours(parts, groups), blank.language)
            if drawn is not None:
                symbols = [
                    replace(symbol, kind=BLANK, is_paper=True) if _is_paper(symbol.group, parts) else symbol
                    for symbol in symbols
                ]
            description = "; ".join(f"{symbol.letter} {symbol.group.name}" for symbol in symbols)
            inked = shapely.union_all(strokes).buffer(DOT_MM / 2)
            free = [shape.difference(inked) for shape in shapes if not shape.is_empty]
            marks, entries = place_texts(texts, [symbol.letter for symbol in symbols], free, sheet, blank.language)
            inked = shapely.union_all([inked, *(around(mark.dots_mm) for mark in marks)])
            page = replace(blank, description=description, texts=(*blank.texts, *marks))
            drawing, near = _draw_clear(page, symbols, shapes, inked)
            if not near:
                return symbols, replace(drawing, strokes=strokes), entries
        parts = open_at(parts, _on_picture([gap.place_mm for gap in near], sheet), wide_mm / 1000, turn + 1)
    if front:  # a thinner line may have the room
        return _draw_readable(replace(blank, figure=None), original, groups, (), drawn, texts)
    raise PictureError(f"{near[0]}, and {GAP_MM} mm must be between them; make the picture larger or simpler")


def _is_paper(group: NamedParts, parts: PartMap) -> bool:
    rim = np.concatenate([parts.labels[0], parts.labels[-1], parts.labels[:, 0], parts.labels[:, -1]])
    return 2 * np.isin(rim, group.numbers).sum() > rim.size


def _on_picture(places_mm: Sequence[tuple[float, float]], sheet: Sheet) -> Float64[np.ndarray, "n 2"]:
    """Return places on the page as shares of the picture's width, from its upper left corner."""
    return np.subtract(places_mm, (sheet.left_mm, sheet.top_mm)) / sheet.picture_mm[0]


def _on_page(parts: PartMap, sheet: Sheet) -> tuple[Any, ...]:
    """Return the shapes of parts in millimetres on the page, y down."""
    rows, columns = parts.labels.shape
    width, length = sheet.picture_mm
    middle = np.array([sheet.left_mm + width / 2, sheet.top_mm + length / 2])
    # The rows of a simplified map are whole, so its sides are those of the picture but for half a row.
    scale = np.array([1, -length * columns / (rows * width)])

    def to_page(at: Float64[np.ndarray, "k 2"]) -> Float64[np.ndarray, "k 2"]:
        return at * scale + middle

    return tuple(shapely.transform(shape, to_page) for shape in smooth_borders(parts, width))


def _neighbours(parts: PartMap, groups: Sequence[NamedParts]) -> list[set[int]]:
    group_of = np.zeros(parts.count, np.int64)
    for place, group in enumerate(groups):
        group_of[list(group.numbers)] = place
    labels = group_of[parts.labels]
    neighbours = [set[int]() for _ in groups]
    for one, other in ((labels[:, 1:], labels[:, :-1]), (labels[1:], labels[:-1])):
        for pair in np.unique(np.stack([one[one != other], other[one != other]]), axis=1).T.tolist():
            neighbours[pair[0]].add(pair[1])
            neighbours[pair[1]].add(pair[0])
    return neighbours


def _choose_symbols(
    groups: Sequence[NamedParts], shapes: Sequence[Any], neighbours: list[set[int]], language: str
) -> list[Symbols]:
    unnamed = [group.name == part_label(group.numbers[0], language) for group in groups]  # get letters in order
    letters = key_letters(["" if is_unnamed else group.name for is_unnamed, group in zip(unnamed, groups, strict=True)])
    plain = [
        Symbols(group, letter, translate(letter, language), BLANK)
        for group, letter in zip(groups, letters, strict=True)
    ]
    choices = [
        [kind for kind in KINDS if kind == BLANK or _has_room(replace(symbol, kind=kind), shapes)] for symbol in plain
    ]
    sizes = [sum(shapes[number].area for number in group.numbers) for group in groups]
    kinds, alike = choose_fills(neighbours, choices, sizes)
    if alike:
        pairs = [f"{groups[one].name} and {groups[other].name}" for one, other in alike]
        note(log, f"neighbours with the same fill, as there are too few: {first_labels(pairs)}", logging.WARNING)
    if len(groups) > len(LETTERS):
        note(
            log,
            f"{len(groups)} parts have letters, two each: many for one page; fewer are read sooner",
            logging.WARNING,
        )
    return [replace(symbol, kind=kind) for symbol, kind in zip(plain, kinds, strict=True)]


def _has_room(symbols: Symbols, shapes: Sequence[Any]) -> bool:
    largest = max(symbols.group.numbers, key=lambda number: shapes[number].area)
    return bool(_area(symbols, shapes[largest]).fill)


def _area(symbols: Symbols, shape: Any, clear_mm: float = CLEAR_MM, inked: Any = None) -> Area:
    """Return a part with its symbols, clear of ink. clear_mm: distance around the letter; infinite for none."""
    free = shape if inked is None else shape.difference(inked)
    dots = place_letter(symbols.cells, free, clear_mm) if clear_mm < np.inf else None
    fill = fill_shape(free, symbols.kind, None if dots is None else around(dots))
    return Area(symbols.group.name, shape, fill, None if dots is None else Braille(symbols.letter, dots))


def _draw_clear(
    blank: Drawing, symbols: Sequence[Symbols], shapes: Sequence[Any], inked: Any
) -> tuple[Drawing, list[Near]]:
    """Move or leave out letters and elements of fills; return the page, and the pairs of marks still too near.

    inked: the places that strokes and texts of the picture take.
    """
    pieces = [(symbol, shapes[number]) for symbol in symbols for number in symbol.group.numbers]
    away, clear_mm = NO_DOTS, [np.inf if symbol.is_paper else CLEAR_MM for symbol, _ in pieces]
    drawing, near = blank, list[Near]()
    for turn in range(ROUNDS):
        areas = [_area(symbol, shape, clear, inked) for (symbol, shape), clear in zip(pieces, clear_mm, strict=True)]
        areas = [replace(area, fill=area.fill.without(away)) if len(away) else area for area in areas]
        drawing = replace(blank, areas=tuple(areas))
        near = too_near(read(svg(drawing)))
        if not near or any(gap.between_outlines for gap in near):
            return drawing, [gap for gap in near if gap.between_outlines]
        for gap in near:
            if fills := [mark.place_mm for mark in gap.marks if mark.what == "fill"]:
                away = np.concatenate([away, fills[-1:]])
            elif (number := _letter_in(gap, areas)) is None:
                return drawing, [gap]
            else:
                clear_mm[number] = clear_mm[number] + GAP_MM - gap.gap_mm + APART_MM if turn < 2 else np.inf
    return drawing, near


def _letter_in(near: Near, areas: Sequence[Area]) -> int | None:
    at = shapely.points(np.array([mark.place_mm for mark in near.marks if mark.what == "braille"]).reshape(-1, 2))
    for number, area in enumerate(areas):
        if area.letter is not None and (shapely.distance(shapely.MultiPoint(area.letter.dots_mm), at) < 0.1).any():
            return number
    return None


def _entries(symbols: Sequence[Symbols], picture: Drawing) -> list[Entry]:
    with_letter = {area.label for area in picture.areas if area.letter}
    has_fill = {area.label for area in picture.areas if area.fill}
    return [
        Entry(
            symbol.group.name,
            symbol.letter if symbol.group.name in with_letter else "",
            symbol.kind if symbol.group.name in has_fill else BLANK,
        )
        for symbol in symbols
        if not symbol.is_paper
    ]


def _note_left_out(symbols: Sequence[Symbols], picture: Drawing) -> None:
    note(log, f"braille by {written_by(picture.language)}")
    kinds = {symbol.group.name: symbol.kind for symbol in symbols if not symbol.is_paper}
    if bare := [area.label for area in picture.areas if area.letter is None and area.label in kinds]:
        note(log, f"no room for a letter in {first_labels(bare)}")
    if bare := [area.label for area in picture.areas if kinds.get(area.label, BLANK) != BLANK and not area.fill]:
        note(log, f"no room for a fill in {first_labels(bare)}")
