"""Pairs that break matchers, over the methods that start from features or from torch."""

import numpy as np
import pytest

from tangible_core.data import DisparityMap, Views
from tangible_core.errors import PictureError
from tangible_core.interfaces import DepthEstimator
from tangible_depth.contour import Contour
from tangible_depth.kornia_report import KorniaReport
from tangible_depth.kornia_zncc import KorniaZNCC
from tangible_depth.report import Report

METHODS = [Report(), Contour(), KorniaReport(), KorniaZNCC()]
NOISE = np.random.default_rng(0)


def noise(*shape: int) -> np.ndarray:
    return NOISE.integers(0, 256, shape).astype(np.uint8)


PAIRS = {
    "one pixel": (noise(1, 1), noise(1, 1)),
    "one row": (noise(1, 50), noise(1, 50)),
    "one column": (noise(50, 1), noise(50, 1)),
    "narrow": (noise(40, 5), noise(40, 5)),
    "flat": (np.full((40, 50), 128, np.uint8), np.full((40, 50), 128, np.uint8)),
    "flat of two levels": (np.zeros((40, 50), np.uint8), np.full((40, 50), 255, np.uint8)),
    "bool": (noise(40, 50) > 128, noise(40, 50) > 128),
    "rgba uint16": (noise(40, 50, 4).astype(np.uint16) * 257, noise(40, 50, 4).astype(np.uint16) * 257),
    "rgb and grey": (noise(40, 50, 3), noise(40, 50)),
    "float over one": (noise(40, 50) * 10.0, noise(40, 50) * 10.0),
    "tiny values": (noise(40, 50) * 1e-9, noise(40, 50) * 1e-9),
    "stripes": (np.tile(np.tile([0, 255], 25).astype(np.uint8), (40, 1)),) * 2,
    "one bright pixel": (np.pad([[255]], 20).astype(np.uint8),) * 2,
}


@pytest.mark.parametrize("method", METHODS, ids=lambda method: type(method).__name__)
@pytest.mark.parametrize("pair", PAIRS)
def test_a_map_of_the_right_kind_comes_out(method: DepthEstimator, pair: str):
    left, right = PAIRS[pair]
    found = method.estimate(Views(left, right))
    assert isinstance(found, DisparityMap)
    assert found.disparity_px.shape == left.shape[:2]
    assert found.disparity_px.dtype == found.confidence.dtype == np.float32
    assert not np.isinf(found.disparity_px).any()
    assert found.confidence.min() >= 0
    assert found.confidence.max() <= 1


@pytest.mark.parametrize("method", METHODS, ids=lambda method: type(method).__name__)
class TestEveryMethod:
    def test_is_a_value(self, method: DepthEstimator):
        assert type(method).model_validate(method.model_dump()) == method
        assert all("description" in field for field in type(method).model_json_schema()["properties"].values())

    def test_leaves_its_pictures_alone_and_repeats_itself(self, method: DepthEstimator):
        left, right = noise(40, 60), noise(40, 60)
        before = left.copy(), right.copy()
        views = Views(left, right)
        assert method.estimate(views).digest() == method.estimate(views).digest()
        assert np.array_equal(left, before[0])
        assert np.array_equal(right, before[1])


@pytest.mark.parametrize("method", [m for m in METHODS if not isinstance(m, Contour)], ids=lambda m: type(m).__name__)
class TestEveryMatcher:
    def test_a_flat_pair_is_unknown(self, method: DepthEstimator):
        flat = np.full((40, 50), 128, np.uint8)
        found = method.estimate(Views(flat, flat))
        assert np.isnan(found.disparity_px).all()
        assert not found.confidence.any()

    def test_the_same_picture_twice_has_no_shift(self, method: DepthEstimator):
        same = noise(60, 80)
        found = method.estimate(Views(same, same))
        assert np.nanmedian(np.abs(found.disparity_px)) < 0.1

    def test_one_view_is_no_pair(self, method: DepthEstimator):
        with pytest.raises(PictureError, match="two views"):
            method.estimate(Views(noise(40, 50)))
