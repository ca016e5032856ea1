"""If one of these fails, a large picture is felt blurred, shifted or without some of its segments."""

import numpy as np
import pytest

from tangible_core.data import Calibration, DisparityMap, SegmentMap, Views
from tangible_core.scene.scaling import enlarged_segments, felt_factor, on_grid, reduce_views, to_picture_pixels


def enlarge_disparity(disparity: DisparityMap, shape: tuple[int, int]) -> DisparityMap:
    return on_grid(to_picture_pixels(disparity, shape[1]), shape)


@pytest.mark.parametrize(
    ("columns", "width_m", "finest_m", "factor"),
    [(6000, 0.08, 3e-5, 2), (8000, 0.08, 3e-5, 3), (2666, 0.08, 3e-5, 1), (6000, 0.08, 0.0, 1), (1, 0.08, 0.1, 1)],
)
def test_felt_factor_keeps_pixels_at_or_under_the_finest_detail(columns, width_m, finest_m, factor):
    assert felt_factor(columns, width_m, finest_m) == factor
    assert factor == 1 or factor * width_m / columns <= finest_m


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.float64, np.bool_])
@pytest.mark.parametrize("channels", [(), (3,), (4,)])
def test_reduced_pixels_are_means(dtype, channels):
    rng = np.random.default_rng(0)
    small = (
        rng.random((4, 6, *channels)) if dtype in (np.float32, np.float64) else rng.integers(0, 2, (4, 6, *channels))
    )
    picture = np.repeat(np.repeat(small, 3, axis=0), 3, axis=1).astype(dtype)
    half = reduce_views(Views(picture, picture, Calibration(1000.0, 0.1)), 3)
    scale = 255 if dtype == np.bool_ else 1
    np.testing.assert_allclose(half.left, small * scale, atol=1e-6)
    assert half.right is not None
    assert half.shape == (4, 6)


def test_enlarged_plane_is_in_pixels_of_the_pictures():
    columns = np.arange(60, dtype=np.float32)
    small = DisparityMap(np.tile(4 + 0.1 * columns, (20, 1)))
    large = enlarge_disparity(small, (40, 120)).disparity_px
    wanted = 2 * (4 + 0.1 * ((np.arange(120) + 0.5) / 2 - 0.5))  # pixel centres of both sizes
    np.testing.assert_allclose(large[:, 2:-2], np.tile(wanted, (40, 1))[:, 2:-2], rtol=1e-5)


def test_enlarged_hole_stays_a_hole_of_its_size():
    values = np.full((4, 6), 5.0, np.float32)
    values[1, 2] = np.nan
    large = enlarge_disparity(DisparityMap(values), (8, 12))
    unknown = np.isnan(large.disparity_px)
    assert unknown[2:4, 4:6].all()
    assert unknown.sum() == 4
    assert (large.disparity_px[~unknown] == 10).all()
    assert large.confidence.shape == (8, 12)


@pytest.mark.parametrize("shape", [(1, 1), (2, 9), (5, 7), (64, 33)])
@pytest.mark.parametrize("factor", [1, 2, 3])
def test_enlarged_segments_keep_every_label(shape, factor):
    small = reduce_views(Views(np.zeros(shape, np.uint8)), factor).shape
    labels = np.arange(small[0] * small[1], dtype=np.int32).reshape(small)
    enlarged = enlarged_segments(SegmentMap(labels, np.full(small, 0.25, np.float32)), shape)
    assert enlarged.labels.dtype == np.int32
    assert np.array_equal(np.unique(enlarged.labels), labels.ravel())
    assert enlarged.confidence.shape == shape
    assert np.all(enlarged.confidence == 0.25)
