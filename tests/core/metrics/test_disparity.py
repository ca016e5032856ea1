"""Measures of disparity, and which pixels both views show."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.errors import PictureError
from tangible_core.metrics import absolute_error, disparity_errors, visible_pixels

NAN = np.nan


def test_measures_equal_those_computed_by_hand():
    truth = np.float32([[1, 2, 3, NAN], [4, 5, 6, 7]])
    found = np.float32([[1, 2.75, NAN, 9], [5.5, 2, 11, np.inf]])
    assert disparity_errors(found, truth) == pytest.approx(
        {
            "bad0.5": 100 * 6 / 7,
            "bad1": 100 * 5 / 7,
            "bad2": 100 * 4 / 7,
            "bad4": 100 * 3 / 7,
            "average_px": (0 + 0.75 + 1.5 + 3 + 5) / 5,
            "rms_px": ((0.75**2 + 1.5**2 + 9 + 25) / 5) ** 0.5,
            "density": 100 * 5 / 7,
        }
    )


def test_error_equal_to_the_bound_is_good():
    assert disparity_errors(np.float32([[2]]), np.float32([[0]]))["bad2"] == 0


def test_maps_without_known_pixels_give_nan():
    unknown = np.full((2, 2), NAN, np.float32)
    assert all(np.isnan(value) for value in disparity_errors(unknown, unknown).values())
    found = disparity_errors(unknown, np.ones((2, 2), np.float32))
    assert (found["bad4"], found["density"]) == (100, 0)
    assert np.isnan(found["average_px"])


@pytest.mark.usefixtures("unchecked_shapes")
def test_maps_of_different_size_are_refused():
    with pytest.raises(PictureError, match=r"\(2, 2\) and its truth \(2, 3\)"):
        absolute_error(np.ones((2, 2)), np.ones((2, 3)))


@given(st.integers(1, 12), st.integers(0, 12))
def test_strip_behind_a_step_is_hidden_as_wide_as_the_jump(jump: int, far: int):
    """The strip is left of a nearer surface, and at the left border."""
    edge, width = 40, 64
    truth = np.full((3, width), far, np.float64)
    truth[:, edge:] = far + jump
    hidden = ~visible_pixels(truth)
    expected = np.zeros(width, np.bool_)
    expected[:far] = True
    if jump > 1:  # less is a slope
        expected[edge - jump : edge] = True
    np.testing.assert_array_equal(hidden, np.tile(expected, (3, 1)))


def test_step_down_hides_nothing():
    truth = np.where(np.arange(64) < 30, 9.0, 2.0)[None]
    np.testing.assert_array_equal(visible_pixels(truth)[0], np.arange(64) >= 9)


def test_thin_bar_hides_its_own_width_only():
    """The bar at 40 jumps over the wall: seen at 40 - 12 it hides the wall of 28 + 2, and none between."""
    truth = np.full((1, 64), 2.0)
    truth[0, 40:43] = 12
    hidden = np.flatnonzero(~visible_pixels(truth)[0])
    assert hidden.tolist() == [0, 1, 30, 31, 32]


def test_surface_stretched_in_the_right_view_has_no_gaps():
    """A slanted one, whose columns lie 1.5 px apart there, hides all of the wall behind it."""
    truth = np.full((1, 30), np.nan, np.float32)
    truth[0, :14] = 0
    truth[0, 20:] = 20 - 0.5 * np.arange(10)
    assert np.flatnonzero(visible_pixels(truth)[0]).tolist() == list(range(20, 30))


def test_negative_disparities_are_visible_alike():
    assert np.flatnonzero(~visible_pixels(np.full((1, 9), -2.0))[0]).tolist() == [7, 8]


def test_slanted_surface_hides_nothing_of_itself():
    for slope in (-0.45, -0.2, 0.3, 0.9):
        truth = 30 + slope * np.arange(60.0)[None]
        seen = np.arange(60) - truth[0] >= -0.5
        np.testing.assert_array_equal(visible_pixels(truth)[0], seen)


def test_pixel_without_truth_is_hidden_and_hides_nothing():
    truth = np.full((1, 20), 2.0)
    truth[0, 10:] = NAN
    np.testing.assert_array_equal(np.flatnonzero(visible_pixels(truth)[0]), np.arange(2, 10))
