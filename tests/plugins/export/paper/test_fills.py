"""Fills in plain shapes: if a case fails, a fill touches its outline, or feels like another one."""

import numpy as np
import pytest
import shapely

from tangible_export.paper import fills
from tangible_export.paper.fills import KINDS, Fill, Lines, fill_shape

STRIP = shapely.box(0, 0, 20.5, 3)
"""Room for four dots: 18 mm and the diameter of a dot, and 0.05 mm on both sides."""
FOUR = np.array([[x, 1.5] for x in (1.25, 7.25, 13.25, 19.25)])


def test_dots_lie_amid_a_strip():
    assert KINDS["dots"](STRIP).dots_mm == pytest.approx(FOUR)
    assert not KINDS["dots"](shapely.box(0, 0, 20.3, 3))


def test_dots_keep_the_clear_distance_from_the_line():
    shape = STRIP.buffer(3.9, join_style="mitre")
    assert fill_shape(shape, "dots").dots_mm == pytest.approx(FOUR)
    assert len(fill_shape(shape, "dots", clear_mm=3.5).dots_mm) == 0


def test_dot_without_a_neighbour_is_left_out():
    alone = shapely.box(35.2, 0, 38.5, 3)
    assert KINDS["dots"](shapely.MultiPolygon([STRIP, alone])).dots_mm == pytest.approx(FOUR)


def test_line_without_another_is_no_fill():
    assert not KINDS["level lines"](shapely.box(0, 0, 36, 4))
    assert len(KINDS["level lines"](shapely.box(0, 0, 36, 11)).strokes) == 3


def test_steep_lines_rise_to_the_right_at_fifty_degrees():
    for stroke in KINDS["steep lines"](shapely.box(0, 0, 50, 40)).strokes:
        right, down = np.ptp(shapely.get_coordinates(stroke), axis=0)
        start, end = shapely.get_coordinates(stroke)
        assert (end - start).prod() < 0  # y runs down
        assert np.degrees(np.arctan2(down, right)) == pytest.approx(50)


def test_of_two_near_strokes_the_longer_one_stays():
    short, long = (shapely.LineString([(0, y), (x, y)]) for x, y in ((8, 0), (30, 3)))
    for strokes in ([short, long], [long, short]):
        assert fills._clear_strokes(strokes, Lines(0.8, 4.3, 0)) == [long]


def test_strokes_as_short_as_dots_are_left_out_and_so_is_a_fill_of_few():
    pieces = [shapely.LineString([(x, 0), (x, length)]) for x, length in ((0, 4.9), (10, 5.1), (20, 10.9), (30, 11.1))]
    assert fills._clear_strokes(pieces, Lines(0.8, 4.3, 0)) == pieces[:0:-1], "the longest first"
    assert fills._clear_strokes(pieces, Lines(0.8, 6.2, 90, least_mm=11)) == pieces[3:]
    assert not KINDS["level lines"](shapely.box(0, 0, 6.1, 10)), "three of 5.3 mm are shorter than 16 mm together"
    assert [stroke.length for stroke in KINDS["level lines"](shapely.box(0, 0, 6.2, 10)).strokes] == pytest.approx(
        [5.4] * 3
    )
    assert len(fills._lines(shapely.box(0, 0, 8.5, 9.5), Lines(0.5, 4, 0)).strokes) == 2, "of 8 mm are just enough"
    assert {stroke.length > 11 for stroke in KINDS["waves"](shapely.box(0, 0, 40, 20)).strokes} == {True}
    assert not KINDS["waves"](shapely.box(0, 0, 40, 10)), "a wave this short is felt as a line"


def test_waves_swing_by_three_millimetres_every_ten():
    for stroke in KINDS["waves"](shapely.box(0, 0, 40, 60)).strokes:
        across, down = shapely.get_coordinates(shapely.segmentize(stroke, 0.05)).T
        assert np.ptp(across) == pytest.approx(3, abs=0.05)
        swing = across - (across.max() + across.min()) / 2
        crossings = np.sort(down[:-1][np.diff(swing > 0)])
        assert len(crossings) > 8 and np.diff(crossings) == pytest.approx(5, abs=0.2)


def test_fill_is_made_without_the_dots_and_strokes_at_a_place():
    strokes = tuple(shapely.LineString([(0, y), (30, y)]) for y in (0, 10))
    made = Fill(FOUR, strokes, 0.8).without(np.array([[7.25, 1.5], [10, 10]]))
    assert made.dots_mm == pytest.approx(FOUR[[0, 2, 3]])
    assert (made.strokes, made.stroke_mm) == (strokes[:1], 0.8)
