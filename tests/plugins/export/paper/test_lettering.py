"""Places of braille on a page: if a case fails, a letter lies outside its part or too near to a fill."""

import numpy as np
import pytest
import shapely

from tangible_export.paper.lettering import around, lines_at, place_letter

L = (0b000111,)
"""Dots 1, 2 and 3, one above the other."""


def test_lines_begin_with_the_edges_of_their_dots():
    assert lines_at("a", [(1,), (1,)], 10, 20).dots_mm == pytest.approx(np.array([[10.72, 20.72], [10.72, 30.72]]))


def test_letter_is_in_the_middle_of_its_part():
    dots = place_letter(L, shapely.box(100, 50, 120, 50 + 20 + 4.68))
    assert dots is not None
    assert dots == pytest.approx(np.array([[110, 60], [110, 62.34], [110, 64.68]]), abs=0.1)


def test_letter_is_in_the_widest_piece_of_its_part():
    small, large = shapely.box(0, 0, 20, 24.68), shapely.box(60, 0, 100, 44.68)
    for pieces in ([small, large], [large, small]):
        dots = place_letter(L, shapely.unary_union([*pieces, shapely.box(10, 5, 70, 8)]))
        assert dots is not None
        assert dots.mean(axis=0) == pytest.approx((80, 22.34), abs=2)


def test_fills_leave_five_millimetres_around_a_letter():
    assert around(np.array([[10.0, 20.0]])).bounds == pytest.approx((10 - 5.72, 20 - 5.72, 10 + 5.72, 20 + 5.72))
