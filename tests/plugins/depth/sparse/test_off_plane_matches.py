import numpy as np
import pytest

from tangible_depth.sparse.off_plane_matches import matches_off
from two_cameras import Scene

WALL_PX = np.array([[1, 0, 6], [0, 1, 0], [0, 0, 1.0]])
"""Lays the wall of a scene upon itself."""


def test_a_small_thing_before_a_wall_is_matched_where_it_is():
    scene = Scene((240, 320), 6.0, 20.0, box=(0.06, 0.08))
    found = matches_off(scene.left(), scene.right(), WALL_PX)
    parallax = found.left_px - found.right_px
    right = np.abs(parallax - [14, 0]).max(axis=1) < 0.5
    assert np.count_nonzero(right) >= 10
    column, row = found.left_px[right].astype(int).T
    assert scene.in_box()[row, column].mean() > 0.9


@pytest.mark.parametrize("exposure", [1.0, 0.6])
def test_nothing_stands_off_a_wall(exposure):
    scene = Scene((240, 320), 6.0, box=(0, 0))
    assert not len(matches_off(scene.left(), exposure * scene.right(), WALL_PX).left_px)


def test_what_the_right_picture_does_not_show_is_not_looked_for():
    scene = Scene((240, 320), 60.0, box=(0, 0))
    shift = np.array([[1, 0, 60], [0, 1, 0], [0, 0, 1.0]])
    assert not len(matches_off(scene.left(), scene.right(), shift).left_px)
