"""If one of these fails, errors of disparity are reported that other benchmarks would not report."""

import numpy as np
import pytest

from tangible_core.errors import PictureError
from tangible_core.metrics import absolute_error, disparity_errors

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
