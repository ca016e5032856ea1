"""Key pages: the letter of each name on the page, a sample of its fill, and the name."""

from dataclasses import dataclass, replace
from typing import Any

import shapely

from ..braille import CELL_PITCH_M, Cells, height_m, translate, wrapped
from .fills import fill_shape
from .lettering import MAX_TITLE_LINES, lines_at, title_at, words
from .marks.svg import Area, Braille, Drawing
from .sheet import CLEAR_MM, LINE_MM, MARGIN_MM, Page, Sheet, empty_sheet

SAMPLE_MM = (36.0, 22.0)  # width and length, with room for three elements of each fill across
BESIDE_MM = 6.0


@dataclass(frozen=True)
class Entry:
    """The entry of one name in the key."""

    name: str
    letter: str
    fill: str
    """The kind of its fill; "" for a text of the picture, which has no sample."""


def key_pages(entries: list[Entry], title: str, language: str, page: Page, like: Sheet) -> list[Drawing]:
    """Return the pages of the key, in the order of the letters. Raises: BrailleError as `wrapped`."""
    heading = f"{title}: {words(language).key}" if title else words(language).key
    sheet = empty_sheet(page, like)
    lines = wrapped(heading, language, sheet.title_width_mm / 1000)[:MAX_TITLE_LINES]
    below = MARGIN_MM + 1000 * height_m(len(lines)) + BESIDE_MM
    rows = sorted(entries, key=lambda entry: (not entry.letter, entry.letter, entry.name))
    description = "; ".join(f"{entry.letter} {entry.name}".strip() for entry in rows)
    blank = Drawing(sheet, heading, description, language, words(language).corner, (), (title_at(heading, lines),))
    columns = 2 if sheet.width_mm > sheet.length_mm else 1
    width = (sheet.width_mm - 2 * MARGIN_MM - (columns - 1) * 2 * BESIDE_MM) / columns
    letters = max(len(translate(entry.letter, language)) for entry in rows)
    pages, column, top = [blank], 0, max(below, sheet.top_mm)
    for entry in rows:
        row = _Row(entry, language, width, letters)
        if top + row.height_mm > sheet.length_mm - MARGIN_MM:
            column, top = column + 1, max(below, sheet.top_mm)
        if column == columns:
            pages, column = [*pages, blank], 0
        pages[-1] = _add_row(pages[-1], row, MARGIN_MM + column * (width + 2 * BESIDE_MM), top)
        top += row.height_mm + CLEAR_MM + LINE_MM
    return pages


class _Row:
    """The row of an entry: its measures and its lines of braille."""

    def __init__(self, entry: Entry, language: str, width_mm: float, letters: int) -> None:
        """letters: number of cells in front of each sample of the key."""
        self.entry = entry
        self.letter: Cells = translate(entry.letter, language)
        self.sample_mm = BESIDE_MM + 1000 * ((letters - 1) * CELL_PITCH_M + CELL_PITCH_M / 2) if letters else 0.0
        self.name_mm = self.sample_mm + SAMPLE_MM[0] + BESIDE_MM
        self.lines = wrapped(entry.name, language, (width_mm - self.name_mm) / 1000)
        self.height_mm = max(SAMPLE_MM[1], 1000 * height_m(len(self.lines)))


def _add_row(page: Drawing, row: _Row, left: float, top: float) -> Drawing:
    middle, entry = top + row.height_mm / 2, row.entry
    text_top = middle - 500 * height_m(len(row.lines))
    box = _box(left + row.sample_mm, middle - SAMPLE_MM[1] / 2)
    texts: list[Braille] = [lines_at(entry.name, row.lines, left + row.name_mm, text_top)]
    texts += [lines_at(entry.letter, [row.letter], left, text_top)] if entry.letter else []
    area = (Area(f"{entry.name}: {entry.fill}", box, fill_shape(box, entry.fill)),) if entry.fill else ()
    return replace(page, areas=(*page.areas, *area), texts=(*page.texts, *texts))


def _box(left: float, top: float) -> Any:
    half = LINE_MM / 2
    return shapely.box(left + half, top + half, left + SAMPLE_MM[0] - half, top + SAMPLE_MM[1] - half)
