"""What a page is made of: if a case fails, its key or its fills do not fit its parts."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from exported_pictures import labels_work
from tangible_core.data import Figure, PartMap, Work
from tangible_export.paper import page
from tangible_export.paper.marks.reading import read
from tangible_export.paper.marks.svg import BLACK, Area, Braille, Drawing, svg
from tangible_export.paper.named_parts import NamedParts, group_by_name
from tangible_export.paper.page import Symbols
from tangible_export.paper.sheet import HEAVY_MM, Sheet
from tangible_export.swell import _aspect

SHEET = Sheet(210, 297, 10, 20, (100, 50))


def symbols(name: str, *numbers: int, kind: str = "blank") -> Symbols:
    return Symbols(NamedParts(name, numbers), name[0], (1,), kind)


def test_groups_of_parts_are_the_largest_first_and_their_neighbours_all_around():
    labels = np.array([[0, 0, 1, 1, 1], [2, 2, 3, 3, 1]], np.int32)
    work = labels_work(labels, ("land", "sea", "isle", "land"))
    groups = group_by_name(work, work.simplified)
    assert [(group.name, group.numbers) for group in groups] == [("land", (0, 3)), ("sea", (1,)), ("isle", (2,))]
    assert page._neighbours(work.simplified, groups) == [{1, 2}, {0}, {0}]
    corner = labels_work(np.array([[0, 0, 1], [2, 2, 1]], np.int32))
    assert page._neighbours(corner.simplified, group_by_name(corner, corner.simplified)) == [{1, 2}, {0, 2}, {0, 1}]


def test_fill_has_room_where_the_largest_part_has():
    shapes = [shapely.box(0, 0, 12, 12), shapely.box(0, 0, 60, 60)]
    assert page._has_room(symbols("sea", 0, 1, kind="dots"), shapes)
    assert page._has_room(symbols("sea", 1, 0, kind="dots"), shapes)
    assert not page._has_room(symbols("sea", 0, kind="dots"), shapes)


def test_key_has_the_letters_and_fills_that_are_on_the_page():
    box = shapely.box(0, 0, 9, 9)
    areas = (Area("sea", box, letter=Braille("s", np.zeros((1, 2)))), Area("land", box))
    drawing = Drawing(SHEET, "", "", "en", "", areas, ())
    entries = page._entries([symbols("sea", 0, kind="dots"), symbols("land", 1)], drawing)
    assert [(entry.name, entry.letter, entry.fill) for entry in entries] == [
        ("sea", "s", "blank"),
        ("land", "", "blank"),
    ]


def test_page_names_the_colour_of_its_marks_unless_it_is_black():
    drawing = Drawing(SHEET, "", "", "en", "", (), ())
    assert [svg(drawing, *colour).partition(" xmlns")[0] for colour in ((), (BLACK,), ("#123",))] == [
        "<svg",
        "<svg",
        '<svg fill="#123"',
    ]


def test_page_has_the_sides_of_the_picture_though_parts_have_others():
    parts = PartMap(np.zeros((20, 31), np.int32), (0,))
    picture = np.zeros((30, 45, 3), np.uint8)
    assert _aspect(Work("Map", "en", {}, picture, ()), parts) == 1.5
    assert _aspect(Work("Map", "en", {}, None, ()), parts) == 1.55


def test_outline_of_the_figure_is_heavier_and_one_for_all_its_parts():
    labels = np.zeros((60, 80), np.int32)
    labels[15:45, 20:60] = 1
    labels[15:45, 40:60] = 2
    work = labels_work(labels, ("wall", "coat", "sleeve"))
    sheet = Sheet(210, 297, 10, 60, (180, 135))
    plain = svg(page.drawn_pages(work, work.simplified, sheet, "a4")[0])
    seen = replace(work, extras={"figure": Figure((labels > 0).astype(np.float32))})
    drawn = svg(page.drawn_pages(seen, work.simplified, sheet, "a4")[0])
    heavy = [mark for mark in read(drawn).marks if mark.stroke_mm == HEAVY_MM]
    assert len(heavy) == 1
    assert np.ptp(heavy[0].shape.vertices, axis=0) == pytest.approx((90, 67.5), abs=1)
    lines = [line for line in plain.splitlines() if 'data-mark="fill"' not in line]
    assert [line for line in drawn.splitlines() if line in lines] == lines, "but for fills, which keep clear of it"
