"""The left-right check: what both views agree on is trusted."""

import numpy as np
from hypothesis import given
from hypothesis.extra import numpy as hnp

from tangible_depth.dense.left_right import left_right_confidence

NAN = np.nan


def test_confidence_falls_from_agreement_to_a_pixel_apart():
    left = np.float32([[0, 0, 2, 2, 2, 2]])
    right = np.float32([[2, 2.25, 3, 1.5, 0, 0]])
    assert left_right_confidence(left, right).tolist() == [[0, 0, 1, 0.75, 0, 0.5]]


def test_fraction_of_a_column_is_looked_up_at_the_nearest():
    left, right = np.float32([[0, 0, 1.25, 1.75]]), np.float32([[0, 1.25, 1.75, 9]])
    assert left_right_confidence(left, right)[0, 2:].tolist() == [1, 0.5]


def test_match_half_a_column_beyond_the_last_is_outside():
    left = np.float32([[0, 0, 0, -0.5]])
    assert left_right_confidence(left, left).tolist() == [[1, 1, 1, 0]]


def test_unknown_or_outside_pixels_have_no_confidence():
    left = np.float32([[1, NAN, 3, -2, -1]])
    right = np.float32([[1, 1, NAN, 1, -1]])
    assert left_right_confidence(left, right).tolist() == [[0, 0, 0, 0, 0]]
    assert left_right_confidence(np.float32([[0, 1]]), np.float32([[NAN, 1]])).tolist() == [[0, 0]]


@given(hnp.arrays(np.float32, (3, 5)), hnp.arrays(np.float32, (3, 5)))
def test_confidence_is_between_0_and_1_for_any_disparities(left, right):
    confidence = left_right_confidence(left, right)
    assert confidence.dtype == np.float32
    assert ((confidence >= 0) & (confidence <= 1)).all()
