"""The range of the chain of features."""

import numpy as np
import pytest

from tangible_core.data import Views
from tangible_depth.matching import feature_chain as module
from tangible_depth.rectify.rectified_pair import warp_pair
from tangible_depth.sparse.matches import NO_MATCHES

VIEWS = Views(*np.random.default_rng(0).integers(0, 256, (2, 20, 90), np.uint8))


@pytest.mark.parametrize(("start_px", "most", "span"), [(0, 40, (0, 40)), (-8, 40, (8, 48)), (5, 40, (-5, 35))])
def test_requested_range_counts_from_the_original_picture(start_px: int, most: int, span: tuple[int, int]):
    rectified = warp_pair(VIEWS, (np.eye(3), np.eye(3)), "", start_px)
    assert module._range(NO_MATCHES, rectified, most) == span
