"""Places on a sheet: if a case fails, the picture is smaller than it could be or runs off the paper."""

import pytest

from tangible_core.errors import GeometryError
from tangible_export.paper.lettering import title_lines
from tangible_export.paper.sheet import Sheet, check_readable, empty_sheet, sheet_for

TOP_MM = 10 + 8 + 3.4 + 0.5
"""Margin, corner mark, clear distance and half a line."""
ROOM_MM = (210 - 20 - 1, 297 - TOP_MM - 10 - 0.5)


def test_sheet_lies_so_that_the_picture_is_largest():
    square = sheet_for("a4", 1.0, None)
    assert (square.width_mm, square.length_mm, square.left_mm, square.top_mm) == (210, 297, 10.5, TOP_MM)
    assert square.picture_mm == (189, 189)
    assert square.spare_mm == pytest.approx(ROOM_MM[1] - 189)
    wide = sheet_for("a4", 2.0, None)
    assert (wide.width_mm, wide.length_mm, wide.picture_mm) == (297, 210, (276, 138))


@pytest.mark.parametrize(
    ("spare_mm", "title_mm", "down_mm"),
    [
        (75.6, 6.12, 10),  # as far as a hand still finds it
        (12.0, 6.12, 6),  # to the middle
        (75.6, 26.12, 10 + 26.12 + 3.4 + 0.5 - TOP_MM),  # clear of three lines
        (5.0, 26.12, 5),
        (0.0, 6.12, 0),
    ],
)
def test_picture_is_moved_below_its_title(spare_mm: float, title_mm: float, down_mm: float):
    below = Sheet(210, 297, 10, TOP_MM, (190, 100), spare_mm).below(title_mm)
    assert below.top_mm - TOP_MM == pytest.approx(down_mm)
    assert below.spare_mm == pytest.approx(spare_mm - down_mm)


def test_picture_of_the_largest_and_of_the_least_width_is_taken():
    for width_m, aspect in ((0.189, 1.0), (0.0127, 1.0), (0.0254, 2.0)):
        check_readable("a4", sheet_for("a4", aspect, width_m))
    for width_m, message in ((0.1891, "no room"), (0.0126, "a finger needs")):
        with pytest.raises(GeometryError, match=message):
            check_readable("a4", sheet_for("a4", 1.0, width_m))


def test_sheet_of_the_key_lies_as_that_of_the_picture():
    for aspect, size in ((1.0, (210, 297)), (2.0, (297, 210))):
        sheet = empty_sheet("a4", sheet_for("a4", aspect, None))
        assert (sheet.width_mm, sheet.length_mm) == size
        assert sheet.picture_mm == pytest.approx((size[0] - 21, size[1] - TOP_MM - 10.5))


@pytest.mark.parametrize(
    ("cells", "spare_mm", "lines", "whole"),
    [(28, 0, 1, True), (29, 0, 1, False), (29, 10, 2, True), (29, 9.9, 1, False), (90, 20, 3, False)],
)
def test_title_has_the_lines_with_room_to_the_left_of_the_corner(cells: int, spare_mm: float, lines: int, whole: bool):
    """A line takes 28 cells: 27 of 6.2 mm and the dots of the last, in 210 less two margins, the mark and two gaps."""
    sheet = Sheet(210, 297, 10, TOP_MM, (190, 100), spare_mm)
    made, complete = title_lines("a" * cells, "en", sheet)
    assert (len(made), complete) == (lines, whole)
    assert len(made[0]) == 28
