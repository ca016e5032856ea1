"""What the numbers of a network mean; without a network."""

import numpy as np
import pytest

from tangible_core.data import Views
from tangible_depth.network.conversion import to_disparity

VIEWS = Views(np.zeros((1, 4), np.uint8))
NAN = np.nan


@pytest.mark.parametrize(
    ("means", "numbers", "wanted"),
    [
        ("depth", [1, 2, 0, -1], [1, 0, NAN, NAN]),
        ("depth-m", [4, 2, 0, np.inf], [0, 1, NAN, NAN]),
        ("inverse-depth", [-3, -1, 0, 1], [0, 0.5, 0.75, 1]),
        ("inverse-depth", [2, 6, NAN, 4], [0, 1, NAN, 0.5]),
        ("disparity-px", [-2, 0, NAN, 5], [-2, 0, NAN, 5]),
        ("inverse-depth", [1, 1 + 2e-7, 1, 1], [0, 0, 0, 0]),
        ("depth", [NAN, NAN, 0, -1], [NAN] * 4),
    ],
)
def test_numbers_become_nearness_or_pixels(means, numbers, wanted):
    found = to_disparity(np.float32([numbers]), None, means, VIEWS)
    assert found.disparity_px.tolist() == [pytest.approx(wanted, nan_ok=True)]
    assert found.confidence.tolist() == [[float(not np.isnan(each)) for each in wanted]]
    assert found.unit == ("px" if means == "disparity-px" else "relative")


def test_confidence_is_a_share_and_none_where_nothing_is_known():
    found = to_disparity(np.float32([[1, 2, 3, NAN]]), np.float32([[0.25, 7, NAN, 0.5]]), "inverse-depth", VIEWS)
    assert found.confidence.tolist() == [[0.25, 1, 0, 0]]
