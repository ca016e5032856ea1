"""If one of these fails, a large picture is felt blurred, shifted, with seams or without its details."""

import numpy as np
import pytest

from tangible_core.data import Calibration, DisparityMap, SegmentMap, Views
from tangible_core.scene.formats.bands import reduced
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


def test_enlarged_plane_is_in_pixels_of_the_pictures_and_keeps_its_holes():
    columns = np.arange(60, dtype=np.float32)
    small = DisparityMap(np.tile(4 + 0.1 * columns, (20, 1)))
    large = enlarge_disparity(small, (40, 120)).disparity_px
    wanted = 2 * (4 + 0.1 * ((np.arange(120) + 0.5) / 2 - 0.5))  # pixel centres of both sizes
    np.testing.assert_allclose(large[:, 2:-2], np.tile(wanted, (40, 1))[:, 2:-2], rtol=1e-5)
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


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.int32])
@pytest.mark.parametrize("channels", [(), (3,)])
@pytest.mark.parametrize("shape", [(12, 15), (10, 11), (11, 13), (1, 1), (2, 14)])
@pytest.mark.parametrize("high", [1, 4, 100])
def test_squares_at_the_right_and_lower_rim_are_cut_short(
    shape: tuple[int, int], channels: tuple[int, ...], dtype: type, high: int
):
    picture = np.random.default_rng(0).integers(0, 200, (*shape, *channels)).astype(dtype)
    bands = (picture[first : first + high] for first in range(0, shape[0], high))
    found = reduced(bands, *shape, 3)
    rim = [(0, -side % 3) for side in shape] + [(0, 0)] * len(channels)
    whole = np.pad(picture.astype(np.float64), rim, mode="edge")
    rows, columns = whole.shape[0] // 3, whole.shape[1] // 3
    means = whole.reshape(rows, 3, columns, 3, *channels).mean(axis=(1, 3))
    assert found.dtype == dtype
    assert found.shape == means.shape
    assert np.abs(found - means).max() <= (1e-4 if dtype is np.float32 else 1)


def test_rows_that_are_missing_are_told():
    with pytest.raises(ValueError, match="its rows end early"):
        reduced([np.zeros((6, 5), np.uint8)], 7, 5, 3)
