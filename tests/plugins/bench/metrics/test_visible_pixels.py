"""Pixels that both views show, by the true disparity."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tangible_bench.metrics.standard_sets import visible_pixels

NAN = np.nan


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


def test_thin_bar_hides_its_own_width_only():
    """The bar at 40 jumps over the wall: seen at 40 - 12 it hides the wall of 28 + 2, and none between."""
    truth = np.full((1, 64), 2.0)
    truth[0, 40:43] = 12
    hidden = np.flatnonzero(~visible_pixels(truth)[0])
    assert hidden.tolist() == [0, 1, 30, 31, 32]
    down = np.where(np.arange(64) < 30, 9.0, 2.0)[None]
    np.testing.assert_array_equal(visible_pixels(down)[0], np.arange(64) >= 9)
    assert np.flatnonzero(~visible_pixels(np.full((1, 9), -2.0))[0]).tolist() == [7, 8], "behind the screen"


def test_surface_stretched_in_the_right_view_has_no_gaps():
    """A slanted one, whose columns lie 1.5 px apart there, hides all of the wall behind it."""
    truth = np.full((1, 30), np.nan, np.float32)
    truth[0, :14] = 0
    truth[0, 20:] = 20 - 0.5 * np.arange(10)
    assert np.flatnonzero(visible_pixels(truth)[0]).tolist() == list(range(20, 30))


def test_slanted_surface_hides_nothing_of_itself():
    for slope in (-0.45, -0.2, 0.3, 0.9):
        truth = 30 + slope * np.arange(60.0)[None]
        seen = np.arange(60) - truth[0] >= -0.5
        np.testing.assert_array_equal(visible_pixels(truth)[0], seen)


def test_pixel_without_truth_is_hidden_and_hides_nothing():
    truth = np.full((1, 20), 2.0)
    truth[0, 10:] = NAN
    np.testing.assert_array_equal(np.flatnonzero(visible_pixels(truth)[0]), np.arange(2, 10))
