import numpy as np
import pytest

from tangible_depth.sparse.corner_range import clip_range, range_of_pair, range_of_shifts
from two_cameras import Scene


def shifts(values, vertical=0.0):
    return np.column_stack([values, np.full(len(values), vertical)])


def test_range_of_shifts_has_a_margin_and_zero():
    assert range_of_shifts(shifts(np.linspace(20, 60, 101)), 500) == (0, 64)
    assert range_of_shifts(shifts(np.linspace(-30, 70, 101)), 500) == (-39, 79)


def test_stray_matches_do_not_widen_the_range():
    values = np.r_[np.linspace(20, 60, 500), [-300, 400]]
    assert range_of_shifts(shifts(values), 500) == (0, 64)
    off_row = np.vstack([shifts(np.linspace(20, 60, 100)), shifts(np.full(30, 400.0), vertical=9)])
    assert range_of_shifts(off_row, 500) == (0, 64)


def test_range_of_few_matches_is_a_quarter_of_the_width():
    assert range_of_shifts(np.empty((0, 2)), 200) == (0, 50)


@pytest.mark.parametrize(
    ("low", "high", "width", "range_px"), [(-9, 9, 4, (-3, 3)), (0, 64, 1, (0, 0)), (5, 2, 9, (5, 5))]
)
def test_range_is_clipped_to_the_picture(low, high, width, range_px):
    assert clip_range(low, high, width) == range_px


def test_range_of_a_pair_covers_its_disparities():
    scene = Scene(wall_px=-7.0, box_px=13.0)
    low, high = range_of_pair(scene.left(), scene.right(), "auto")
    assert -25 <= low <= -7
    assert 13 <= high <= 30
    assert range_of_pair(scene.left(), scene.right(), 40) == (0, 40)


@pytest.mark.parametrize(("count", "range_px"), [(19, (0, 50)), (20, (0, 44))])
def test_twenty_matches_within_two_rows_make_a_range(count, range_px):
    assert range_of_shifts(shifts(np.full(count, 40.0), vertical=2.0), 200) == range_px
    assert range_of_shifts(shifts(np.full(count, 40.0), vertical=-2.0), 200) == range_px
    assert range_of_shifts(shifts(np.full(count, 40.0), vertical=2.1), 200) == (0, 50)
