"""The key: if a case fails, a sample stands by the wrong name, or the page can be laid the wrong way up."""

import re

import pytest
import shapely

from tangible_export.paper.key import Entry, key_pages
from tangible_export.paper.marks.svg import svg
from tangible_export.paper.sheet import sheet_for

UPRIGHT, LEVEL = sheet_for("a4", 1.0, None), sheet_for("a4", 2.0, None)
FIRST_MM = 10 + 6.12 + 6 + 0.5
"""Upper edge of the first sample: margin, a line of braille, the distance below it, and half a line."""
APART_MM = 22 + 3.4 + 1


def boxes(page) -> list[tuple[float, float, float, float]]:
    return [shapely.bounds(area.outline).tolist() for area in page.areas]


def test_key_is_in_the_order_of_letters_and_names_without_one_come_last():
    entries = [Entry("zebra", "", "blank"), Entry("ant", "b", "dots"), Entry("bee", "a", "blank")]
    [page] = key_pages([*entries, Entry("cow", "", "waves")], "Map", "en", "a4", UPRIGHT)
    assert [area.label for area in page.areas] == ["bee: blank", "ant: dots", "cow: waves", "zebra: blank"]
    assert page.description == "a bee; b ant; cow; zebra"


def test_key_has_ten_rows_a_page_and_two_columns_on_its_side():
    entries = [Entry(f"n{chr(97 + n)}", chr(97 + n), "blank") for n in range(25)]
    assert [len(page.areas) for page in key_pages(entries, "Map", "en", "a4", UPRIGHT)] == [10, 10, 5]
    pages = key_pages(entries, "Map", "en", "a4", LEVEL)
    assert [len(page.areas) for page in pages] == [12, 12, 1]
    tops = [top for _, top, _, _ in boxes(pages[0])]
    assert tops == pytest.approx([FIRST_MM + row * APART_MM for row in range(6)] * 2)
    lefts = [left for left, _, _, _ in boxes(pages[0])]
    assert lefts[6] - lefts[0] == pytest.approx((277 - 12) / 2 + 12)


def test_key_makes_room_for_a_name_of_several_lines():
    long = Entry("a broad and shallow bay with a name of several lines", "a", "blank")
    [page] = key_pages([long, Entry("sea", "b", "blank")], "Map", "en", "a4", UPRIGHT)
    first, second = boxes(page)
    assert second[1] - first[1] == pytest.approx(APART_MM + (26.12 - 22) / 2)


@pytest.mark.parametrize(("letter", "left_mm"), [("b", 9.1), ("bc", 15.3)])
def test_key_sample_stands_clear_of_the_letters(letter: str, left_mm: float):
    [page] = key_pages([Entry("bay", letter, "blank")], "Map", "en", "a4", UPRIGHT)
    assert boxes(page)[0][0] == pytest.approx(10 + left_mm + 0.5)


def test_corner_mark_points_to_the_upper_right():
    [page] = key_pages([Entry("bay", "b", "blank")], "Map", "en", "a4", UPRIGHT)
    assert re.findall(r'data-mark="corner".* d="(.*)"', svg(page)) == ["M192.00 10.00L200.00 10.00L200.00 18.00Z"]
