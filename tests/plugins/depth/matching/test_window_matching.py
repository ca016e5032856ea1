"""The confidence of matched windows."""

import numpy as np
import pytest

from tangible_depth.dense.span import Span
from tangible_depth.matching.window_matching import match_by_correlation, match_by_difference
from tangible_depth.search.pairs import Pair


@pytest.mark.parametrize("window_px", [3, 7])
@pytest.mark.parametrize("brighter", [0, 10, 20])
def test_confidence_of_squared_differences_is_that_of_their_mean(window_px: int, brighter: int):
    """It falls to 1 / e at a difference of 20 levels."""
    left = np.random.default_rng(0).integers(0, 230, (30, 60), np.uint8)
    pair = Pair.of(left, left + np.uint8(brighter))
    found = match_by_difference(pair, Span(0, 0), window_px).confidence[10:-10, 10:-10]
    np.testing.assert_allclose(found, np.exp(-((brighter / 20) ** 2)), atol=1 / 255)
    assert match_by_correlation(pair, Span(0, 0), window_px).confidence[15, 20] == pytest.approx(1, abs=1e-4)
