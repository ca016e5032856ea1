"""Smaller sizes: the middle of the known disparities of a block, and masks of most of its pixels."""

import numpy as np
import pytest

from tangible_bench.datasets.standard_pair import shrink_mask, shrink_truth, shrink_views
from tangible_core.data import Calibration, Views

NAN = float("nan")


@pytest.mark.parametrize(
    ("block", "found"),
    [
        ([8.0, 2.0, 6.0, 4.0], 3.0),  # the upper one of the two in the middle, in pixels of half the size
        ([8.0, 2.0, NAN, 4.0], 2.0),
        ([NAN, 2.0, 6.0, NAN], 3.0),  # just half of them are known
        ([NAN, 2.0, NAN, NAN], NAN),
        ([NAN, NAN, NAN, NAN], NAN),
    ],
)
def test_disparity_of_a_block_is_the_upper_middle_of_those_known(block: list[float], found: float):
    truth_px = np.float32([[*block[:2], 5.0, 5.0], [*block[2:], 5.0, 5.0]])
    np.testing.assert_array_equal(shrink_truth(truth_px, 2), np.float32([[found, 2.5]]))


@pytest.mark.parametrize(("block", "marked"), [([1, 0, 1, 0], False), ([1, 1, 1, 0], True), ([0, 0, 0, 0], False)])
def test_block_is_marked_if_most_of_it_is(block: list[int], marked: bool):
    mask = np.array([[*block[:2], 1, 1], [*block[2:], 1, 1]], bool)
    assert shrink_mask(mask, 2).tolist() == [[marked, True]]


def test_views_are_means_of_blocks_with_smaller_cameras():
    left, right = np.uint8([[0, 4, 10], [8, 12, 10]]), np.uint8([[20, 20, 0], [40, 40, 0]])
    found = shrink_views(Views(left, right, Calibration(900.0, 0.2, 30.0)), 2)
    assert (found.left.tolist(), found.right.tolist()) == ([[6]], [[30]])
    assert vars(found.calibration) == vars(Calibration(450.0, 0.2, 15.0))
