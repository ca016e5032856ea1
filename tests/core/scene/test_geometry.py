"""If one of these fails, a surface has other heights, slopes or places than the map it is made of."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tangible_core.data import Calibration, DisparityMap, Relief
from tangible_core.errors import GeometryError
from tangible_core.scene.geometry import (
    ValueRange,
    disparity_to_depth,
    fill_rows,
    flat_relief,
    make_relief,
    normals,
    picture_to_workspace,
    resample,
    scale_heights,
    slopes,
    smooth,
    workspace_to_picture,
)

NAN = np.nan
SIDES = st.integers(1, 12)
SHAPES = st.tuples(SIDES, SIDES)


def disparity(*rows, unit="px"):
    return DisparityMap(np.array(rows, np.float32), unit=unit)


def plane(shape, across, along, extent_m=(0.08, 0.06)):
    """Heights of a plane at the centres of its cells, nowhere below 0 on the whole extent."""
    columns, rows = np.meshgrid(np.arange(shape[1]), np.arange(shape[0]))
    x, y = picture_to_workspace(columns, rows, shape, extent_m)
    lowest = abs(across) * extent_m[0] / 2 + abs(along) * extent_m[1] / 2
    return Relief((lowest + across * x + along * y).astype(np.float32), extent_m)


def test_depth_is_focal_length_times_baseline_over_disparity():
    depth_m = disparity_to_depth(np.float32([[50, 25, 12.5]]), focal_px=1000, baseline_m=0.2)
    assert depth_m.dtype == np.float32
    assert depth_m.tolist() == [[4, 8, 16]]
    assert disparity_to_depth(np.float32([[50]]), 1000, 0.2, offset_px=50).tolist() == [[2]]
    assert np.isnan(disparity_to_depth(np.float32([[NAN, 0, -3]]), 1000, 0.2)).all()
    with pytest.raises(GeometryError, match="every value is unknown"):
        fill_rows(np.full((2, 3), NAN, np.float32))


@given(hnp.arrays(np.float32, SHAPES, elements=st.sampled_from([NAN, -1.0, 0.0, 2.0, -np.inf])))
def test_fill_rows_equals_a_slow_version(values):
    if np.isnan(values).all():
        return
    before = values.copy()
    filled = fill_rows(values)
    np.testing.assert_array_equal(values, before)
    for row, (old, new) in enumerate(zip(values, filled, strict=True)):
        known = np.flatnonzero(~np.isnan(old))
        if known.size == 0:
            rows = np.flatnonzero(~np.isnan(values).all(axis=1))
            np.testing.assert_array_equal(new, filled[rows[np.argmin(np.abs(rows - row))]])
            continue
        for column in range(old.size):
            beside = [*known[known <= column][-1:], *known[known >= column][:1]]
            assert new[column] == min(old[beside])


def test_relief_without_calibration_is_linear_in_disparity():
    relief = make_relief(disparity([0, 1, 2, 4]), None, width_m=0.08, relief_m=0.02)
    assert relief.height_m.dtype == np.float32
    np.testing.assert_allclose(relief.height_m, [[0, 0.005, 0.01, 0.02]], atol=4e-4)  # percentiles of four values
    assert relief.extent_m == (0.08, 0.02)


def test_relief_with_calibration_is_linear_in_depth_unless_disparity_is_relative():
    """At 1, 2 and 4 m, where d + offset is 10, 5 and 2.5 px."""
    for offset_px in (0, 30):
        camera = Calibration(focal_px=100, baseline_m=0.1, offset_px=offset_px)
        disparity_px = np.float32([[10, 5, 2.5]] * 500) - np.float32(offset_px)
        relief = make_relief(DisparityMap(disparity_px), camera, 0.06, 0.03)
        np.testing.assert_allclose(relief.height_m, [[0.03, 0.02, 0]] * 500, atol=1e-7)
    camera = Calibration(focal_px=100, baseline_m=0.1)
    relief = make_relief(disparity(*[[0, 0.5, 1]] * 500, unit="relative"), camera, 0.06, 0.02)
    np.testing.assert_allclose(relief.height_m, [[0, 0.01, 0.02]] * 500, atol=1e-8)
    relief = make_relief(disparity(*[[5, 10, 0, -3, 10]] * 500), camera, 0.06, 0.02)
    np.testing.assert_allclose(relief.height_m, [[0, 0.02, 0, 0, 0.02]] * 500, atol=1e-8)


def test_range_clips_half_a_percent_at_each_end_and_ignores_holes():
    """Of 2001 equally spaced values the ten least are as low as the next, and the ten greatest as high."""
    values = np.random.default_rng(3).permutation(2001).astype(np.float32)
    heights = make_relief(DisparityMap(values[None]), None, 0.1, 0.0198).height_m[0]
    np.testing.assert_allclose(heights, np.clip(values - 10, 0, 1980) * 1e-5, atol=1e-9)
    values = np.full((3, 2001), NAN, np.float32)
    values[0] = np.arange(2001)
    values[1:, 0] = 0
    for holes in ("fill", "cut"):
        heights = make_relief(DisparityMap(values), None, 0.1, 0.0198, holes).height_m
        np.testing.assert_allclose(heights[0], np.clip(values[0] - 10, 0, 1980) * 1e-5, rtol=2e-3, atol=2e-5)
        assert not heights[1:].any()


def test_thing_smaller_than_the_percentiles_stands_out_of_a_flat_wall():
    values = np.full((100, 100), 7, np.float32)
    values[50, 50] = 9
    heights = make_relief(DisparityMap(values), None, 0.1, 0.02).height_m
    assert heights[50, 50] == np.float32(0.02)
    assert np.count_nonzero(heights) == 1


@pytest.mark.parametrize("value", [1e-30, 7.3, 1e30])
def test_values_equal_up_to_rounding_make_a_flat_relief(value):
    twice = np.float32([[value, np.nextafter(np.float32(value), np.float32(np.inf))]])
    assert not make_relief(DisparityMap(twice), None, 0.1, 0.02).height_m.any()
    assert not scale_heights(twice, 0.1, 0.02).height_m.any()


def test_holes_are_filled_from_the_background_or_cut_to_the_base():
    torn = disparity(*[[4, NAN, 2, 3, 3]] * 200)
    filled = make_relief(torn, None, 0.1, 0.02).height_m[0]
    cut = make_relief(torn, None, 0.1, 0.02, "cut").height_m[0]
    np.testing.assert_allclose(filled, [0.02, 0, 0, 0.01, 0.01], atol=1e-8)
    np.testing.assert_allclose(cut, [0.02, 0, 0, 0.01, 0.01], atol=1e-8)
    raised = make_relief(disparity(*[[4, NAN, 3, 2]] * 200), None, 0.1, 0.02).height_m[0]
    np.testing.assert_allclose(raised, [0.02, 0.01, 0.01, 0], atol=1e-8)


@pytest.mark.parametrize("holes", ["fill", "cut"])
def test_relief_without_known_depth_raises(holes):
    with pytest.raises(GeometryError, match="no depth is known anywhere"):
        make_relief(disparity([NAN, NAN]), None, 0.1, 0.02, holes)


def test_relief_of_depth_at_infinity_raises():
    with pytest.raises(GeometryError, match="not swapped"):
        make_relief(disparity([-3, -2]), Calibration(100, 0.1), 0.1, 0.02)


@pytest.mark.parametrize(("width_m", "relief_m"), [(0, 1), (-1, 1), (1, 0), (1, -1), (NAN, 1), (1, np.inf)])
def test_relief_refuses_sizes_that_are_not_positive(width_m, relief_m):
    with pytest.raises(GeometryError, match="positive lengths in metres"):
        make_relief(disparity([1, 2]), None, width_m, relief_m)
    with pytest.raises(GeometryError, match="positive lengths in metres"):
        scale_heights(np.float32([[1, 2]]), width_m, relief_m)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int32, np.float32, np.float64])
def test_height_map_runs_from_the_base_to_the_relief(dtype):
    relief = scale_heights(np.array([[10, 20], [30, 50]], dtype), 0.1, 0.02)
    np.testing.assert_allclose(relief.height_m, [[0, 0.005], [0.01, 0.02]], rtol=1e-6)
    assert relief.extent_m == (0.1, 0.1)


def test_height_map_is_scaled_between_its_known_heights_without_clipping():
    heights = np.array([[3, NAN, 2, np.inf, 1]])
    assert scale_heights(heights, 0.1, 1.0).height_m.tolist() == [[1, 0.5, 0.5, 0, 0]]
    assert scale_heights(heights, 0.1, 1.0, "cut").height_m.tolist() == [[1, 0, 0.5, 0, 0]]
    heights = np.zeros((100, 100))
    heights[3, 4], heights[5, 6] = 1, 2
    assert scale_heights(heights, 0.1, 0.02).height_m[3, 4] == np.float32(0.01)
    with pytest.raises(GeometryError, match="holds only NaN or infinity"):
        scale_heights(np.full((3, 3), NAN), 0.1, 0.02)


@example(np.array([[6.5746638e16, -6.0546875e-2]]))  # the quotient by the largest is rounded
@given(hnp.arrays(np.float64, SHAPES))
def test_any_height_map_gives_heights_in_range_or_one_error(heights):
    try:
        relief = scale_heights(heights, 0.08, 0.02)
    except GeometryError:
        assert not np.isfinite(heights).any()
        return
    assert relief.height_m.min() == 0
    assert relief.height_m.max() <= np.float32(0.02)


def test_flat_relief_has_square_cells_and_corners_are_those_of_the_workspace():
    relief = flat_relief((2, 4), 0.08)
    assert not relief.height_m.any()
    assert relief.pitch_m == (0.02, 0.02)
    with pytest.raises(GeometryError):
        flat_relief((0, 0), 0.08)
    shape, extent = (30, 40), (0.08, 0.06)
    assert picture_to_workspace(-0.5, -0.5, shape, extent) == pytest.approx((-0.04, 0.03))
    assert picture_to_workspace(39.5, 29.5, shape, extent) == pytest.approx((0.04, -0.03))
    assert picture_to_workspace(19.5, 14.5, shape, extent) == pytest.approx((0, 0))


@given(st.floats(-100, 100), st.floats(-100, 100), SHAPES, st.tuples(st.floats(0.01, 1), st.floats(0.01, 1)))
def test_workspace_to_picture_inverts_picture_to_workspace(column, row, shape, extent):
    back = workspace_to_picture(*picture_to_workspace(column, row, shape, extent), shape, extent)
    assert back == pytest.approx((column, row), abs=1e-9)


@given(SHAPES, SHAPES, st.floats(-2, 2), st.floats(-2, 2))
def test_resampled_plane_is_the_same_plane(shape, other, across, along):
    across, along = across * (shape[1] > 1), along * (shape[0] > 1)
    again = resample(plane(shape, across, along), other)
    wanted = plane(other, across, along)
    assert again.extent_m == wanted.extent_m
    np.testing.assert_allclose(again.height_m, wanted.height_m, rtol=1e-5, atol=1e-7)


@given(hnp.arrays(np.float32, SHAPES, elements=st.floats(0, 100, width=32)), SHAPES)
def test_resampling_keeps_the_volume_and_stays_above_the_base(heights, shape):
    relief = Relief(heights, (0.1, 0.2))
    again = resample(relief, shape)
    assert again.height_m.shape == shape
    assert again.height_m.mean(dtype=np.float64) == pytest.approx(heights.mean(dtype=np.float64), rel=1e-5, abs=1e-6)


def test_facets_stay_in_the_range_of_their_neighbours():
    """The central difference, no more than twice the lesser step; a peak is level."""
    peaks = {(1, 2, 1.5): (2, 2), (2, 1, 1.5): (1, 1)}
    slopes_up = {(1, 2, 4): (1.625, 2.375), (1, 2, 11): (1.5, 2.5), (9, 2, 1): (2.5, 1.5), (1, 2, 3): (1.75, 2.25)}
    for heights, halves in {**slopes_up, **peaks}.items():
        relief = Relief(np.float32([heights]), (1, 1))
        assert resample(relief, (1, 6)).height_m[0, 2:4] == pytest.approx(halves)


@pytest.mark.parametrize("shape", [(0, 4), (4, 0), (-1, 2)])
def test_resampling_to_no_cells_raises(shape):
    with pytest.raises(GeometryError, match="at least one cell"):
        resample(flat_relief((2, 2), 0.1), shape)


@pytest.mark.parametrize("sigma_px", [0.4, 0.6, 0.9])
@pytest.mark.parametrize("across", [True, False])
def test_smoothing_under_a_pixel_acts_where_it_is_sampled(sigma_px, across):
    """A wave of 8 cells falls by what the Gaussian's samples say; along cells twenty times as long, nothing happens."""
    wave = np.cos(np.arange(64) * np.pi / 4) * np.ones((64, 1))
    shape_m = (0.064, 1.28) if across else (1.28, 0.064)
    steps = np.arange(-8, 9)
    weights = np.exp(-(steps**2) / (2 * sigma_px**2))
    left = weights @ np.cos(steps * np.pi / 4) / weights.sum()
    for turned, falls in ((wave, across), (wave.T, not across)):
        smoothed = smooth(Relief((0.01 + 0.005 * turned).astype(np.float32), shape_m), sigma_px * 0.001).height_m
        inside = np.s_[8:-8, 8:-8]
        expected = 0.01 + 0.005 * (left if falls else 1) * turned
        np.testing.assert_allclose(smoothed[inside], expected[inside], atol=5e-6)
    assert left < 0.98


def test_smoothing_by_nothing_returns_the_relief_itself():
    relief = Relief(np.random.default_rng(0).random((5, 7), np.float32), (0.07, 0.05))
    assert smooth(relief, 0.0) is relief
    assert smooth(relief, 1e-5) is relief
    flat = smooth(flat_relief((5, 7), 0.07), 0.01)
    assert not flat.height_m.any()
    assert smooth(flat_relief((1, 1), 0.07), 0.1).height_m.shape == (1, 1)


@pytest.mark.parametrize("sigma_m", [-0.001, np.nan, np.inf])
def test_smoothing_refuses_negative_and_infinite_lengths(sigma_m):
    with pytest.raises(GeometryError, match="sigma_m"):
        smooth(flat_relief((2, 2), 0.1), sigma_m)


@given(SHAPES, st.floats(-2, 2), st.floats(-2, 2))
def test_slopes_and_normals_of_a_plane_are_exact_in_the_workspace_frame(shape, across, along):
    relief = plane(shape, across, along)
    slopes_of_plane = slopes(relief)
    wanted = (across if shape[1] > 1 else 0, along if shape[0] > 1 else 0)
    for got, want in zip(slopes_of_plane, wanted, strict=True):
        assert got.dtype == np.float32
        np.testing.assert_allclose(got, np.full(shape, want), atol=1e-4)
    up = np.array([-wanted[0], -wanted[1], 1]) / np.sqrt(1 + wanted[0] ** 2 + wanted[1] ** 2)
    np.testing.assert_allclose(normals(relief), np.broadcast_to(up, (*shape, 3)), atol=1e-4)


def test_relief_with_a_given_range_clips_values_beyond_it_only():
    values = np.tile(np.arange(10, dtype=np.float32), (4, 1))
    made = make_relief(DisparityMap(values), None, 0.08, 0.01, spans=ValueRange(2, 6))
    assert np.allclose(made.height_m[0], 0.01 * np.clip((np.arange(10) - 2) / 4, 0, 1))
