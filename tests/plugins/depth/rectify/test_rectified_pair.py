"""Warped pairs: where the pictures lie, and the way back."""

import numpy as np
import pytest

from tangible_core.data import DisparityMap, Views
from tangible_depth.rectify.homographies import transform
from tangible_depth.rectify.rectified_pair import unchanged_pair, warp_pair

LEFT, RIGHT = np.random.default_rng(0).integers(0, 256, (2, 20, 31), np.uint8)
STILL = np.eye(3), np.eye(3)


@pytest.mark.parametrize("start_px", [0, -5, 4])
def test_right_view_moves_so_that_the_start_becomes_zero(start_px: int):
    found = warp_pair(Views(LEFT, RIGHT), STILL, "", start_px, verified_px=(-3, 9))
    assert np.array_equal(found.views.left, LEFT)
    columns = np.clip(np.arange(31) - start_px, 0, 30)
    assert np.array_equal(found.views.right, RIGHT[:, columns])
    assert (found.offset_px, found.verified_px) == (start_px, (-3 - start_px, 9 - start_px))


def test_disparity_and_place_in_the_right_picture_count_the_move():
    found = warp_pair(Views(LEFT, RIGHT), STILL, "", -5)
    disparity_px = np.full((20, 31), np.float32(7))
    back = found.to_original(DisparityMap(disparity_px, np.full((20, 31), np.float32(0.5))))
    assert (back.disparity_px == 2).all()
    assert (back.confidence == 0.5).all()
    y, x = np.indices((20, 31), np.float64)
    assert found.right_px(back.disparity_px) == pytest.approx(np.dstack([x - 2, y]))


def test_canvas_holds_the_whole_left_picture_and_nothing_beyond_it():
    """The left picture is turned by a right angle; what the canvas does not show is unknown in the original."""
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    found = warp_pair(Views(LEFT, RIGHT), (turn, turn), "")
    assert np.array_equal(found.views.left, np.rot90(LEFT, -1))
    values = np.indices(found.views.shape, np.float32).sum(axis=0)
    assert np.array_equal(found.to_original(DisparityMap(values)).disparity_px, np.rot90(values))


def test_lens_leaves_pixels_beyond_its_view_unknown():
    """The view is shifted by half of itself."""
    found = warp_pair(Views(LEFT, RIGHT), STILL, "", 0, (-0.1, -0.1))
    half = np.full((found.views.shape[0], found.views.shape[1] // 2), np.float32(3))
    back = found.to_original(DisparityMap(half)).disparity_px
    places = found.left_place_px(np.column_stack([each.ravel() for each in np.indices((20, 31))[::-1]]))
    seen = (np.rint(places[:, 0]) < half.shape[1]).reshape(20, 31)
    assert np.array_equal(np.isfinite(back), seen)
    moved = found.__class__(**{**vars(found), "left_homography": np.array([[1, 0, -9], [0, 1, 0], [0, 0, 1.0]])})
    values = np.full(found.views.shape, np.float32(3))
    assert np.isnan(moved.to_original(DisparityMap(values)).disparity_px[:, :4]).all()


def test_warped_values_stay_within_those_of_the_picture():
    """Cubic interpolation runs over at a step."""
    step = np.where(np.arange(31) < 15, 0.2, 0.7) * np.ones((20, 1))
    half = np.array([[1, 0, 0.5], [0, 1, 0], [0, 0, 1.0]])
    found = warp_pair(Views(step, step), (STILL[0], half), "")
    assert (found.views.right.min(), found.views.right.max()) == (0.2, 0.7)


def test_other_pictures_are_warped_alike_and_those_of_a_skipped_pair_stay():
    turn = np.array([[1, 0.1, 2], [-0.1, 1, 3], [0, 0, 1.0]])
    found = warp_pair(Views(LEFT, RIGHT), (turn, turn), "", -2)
    again = found.warp(Views(RIGHT, LEFT)).warp(Views(LEFT, RIGHT))
    assert np.array_equal(again.views.left, found.views.left)
    assert np.array_equal(again.views.right, found.views.right)
    other = Views(RIGHT, LEFT)
    assert unchanged_pair(Views(LEFT, RIGHT), "").warp(other).views is other


def test_places_in_a_view_are_those_of_its_homography_without_a_lens():
    turn = np.array([[1, 0.1, 2], [-0.1, 1, 3], [0, 0, 1.0]])
    found = warp_pair(Views(LEFT, RIGHT), (turn, STILL[1]), "", -2)
    points = np.array([[3.0, 4.0], [30.0, 19.0]])
    assert found.left_place_px(points) == pytest.approx(transform(found.left_homography, points))
    assert found.left_place_px(points)[:, 1] - found.right_place_px(points)[:, 1] == pytest.approx(
        transform(turn, points)[:, 1] - points[:, 1]
    )
