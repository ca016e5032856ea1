"""If one of these fails, a relief is too steep, too low or untrue to the depths of its map."""

import numpy as np
import pytest

from tangible_core.data import Calibration, DisparityMap
from tangible_core.relief import ReliefChoice, ReliefScale, shape_relief
from tangible_core.relief.shaping import GRAIN_HIGH_M, STRAIGHT
from tangible_core.scene import geometry
from tangible_core.scene.geometry import ValueRange
from tangible_core.scene.workspace import FeltSize, Workspace

WIDTH_M, HIGH_M = 0.08, 0.005
PLAIN = {"slope": 0, "spread": 0, "accent_m": 0, "grain_m": 0}
UNDISTORTED = {"spread": 0, "accent_m": 0}
CAMERA = Calibration(focal_px=1000.0, baseline_m=0.1)


def size(**changes):
    return FeltSize(WIDTH_M, *SIZE[1:])._replace(**changes)


SIZE = Workspace().size("depth")


def shaped(values, choice=None, camera=None, scale=None, **sizes):
    """Return the heights of a map; choice: options, on top of the defaults."""
    disparity = DisparityMap(np.asarray(values, np.float32))
    return shape_relief(disparity, camera, size(**sizes), ReliefChoice(**(choice or {})), scale).height_m


def two_levels(columns=800, rows=40, low=10.0, high=20.0):
    """Return ground on the left and a block on the right."""
    values = np.full((rows, columns), low, np.float32)
    values[:, columns // 2 :] = high
    return values


def bar(width_m, columns=800):
    """Return a bar that stands before ground, as wide as this, in the middle."""
    values = np.full((200, columns), 10, np.float32)
    half = round(width_m / WIDTH_M * columns / 2)
    values[:, columns // 2 - half : columns // 2 + half] = 20
    return values


@pytest.mark.parametrize("camera", [None, CAMERA])
@pytest.mark.parametrize("holes", ["fill", "cut"])
def test_plain_choice_is_the_linear_relief(camera, holes):
    values = np.random.default_rng(0).uniform(1, 9, (12, 17)).astype(np.float32)
    values[3:5, 4:9] = np.nan
    found = shaped(values, {**PLAIN, "by": "depth"}, camera, smooth_m=0, holes=holes)
    expected = geometry.make_relief(DisparityMap(values), camera, WIDTH_M, HIGH_M, holes).height_m
    assert np.allclose(found, expected, atol=1e-9)
    assert not np.array_equal(found, shaped(values, smooth_m=0))


@pytest.mark.parametrize(("columns", "kept"), [(1333, True), (1600, False)])
def test_cells_are_two_fifths_of_the_rounding_wide(columns, kept):
    """Under a rounding of 0.2 mm cells are 0.08 mm wide: one pixel of 0.06 mm, one and a half of 0.05 mm."""
    values = np.random.default_rng(6).uniform(1, 9, (20, columns)).astype(np.float32)
    relief = geometry.make_relief(DisparityMap(values), None, WIDTH_M, HIGH_M)
    every_pixel = geometry.smooth(relief, 0.0002).height_m
    assert np.allclose(shaped(values, PLAIN, smooth_m=0.0002), every_pixel, atol=1e-6) == kept


def rough(deviation_m, columns=800):
    """Return squares of 2 x 2 pixels, alternately higher and lower than the middle by this, between both ends."""
    y, x = np.indices((40, columns)) // 2
    values = (15 + (20 - 10) / HIGH_M * deviation_m * (-1.0) ** (x + y)).astype(np.float32)
    values[:, :100], values[:, -100:] = 10, 20
    return values


@pytest.mark.parametrize("times", [0.5, 1, 3])
def test_grain_is_flattened_by_its_height(times):
    """Of variance v, v / (v + g^2) is kept (He et al. 2013, formula 5), where g is the height of grain."""
    deviation_m = times * GRAIN_HIGH_M
    found = shaped(rough(deviation_m), {**PLAIN, "grain_m": 0.0003}, smooth_m=0)[10:30, 300:500]
    assert GRAIN_HIGH_M == 1e-4
    assert found.std() / deviation_m == pytest.approx(times**2 / (times**2 + 1), rel=0.02)


@pytest.mark.parametrize(("grain_m", "radius"), [(0.0002, 1), (0.0004, 2), (0.0012, 6)])
def test_grain_is_kept_within_two_windows_of_a_cliff(grain_m, radius):
    """In windows of this radius, in cells of 0.2 mm, noise beside the cliff is none, and such windows are averaged."""
    found = shaped(rough(0.5 * GRAIN_HIGH_M), {**PLAIN, "grain_m": grain_m}, smooth_m=0)[10:30]
    left = found[:, 100:500].std(axis=0)
    assert np.flatnonzero(left > 1.02 * left[-1])[-1] // 2 == 2 * radius


def test_word_depth_keeps_true_proportions():
    """Half as near is twice as far: heights are linear in depth, and level ground stays as high as it is."""
    values = np.repeat(np.float32([10, 12.5, 100 / 6, 25]), 200)[None].repeat(100, axis=0)
    found = shaped(values, {"by": "depth"}, CAMERA)[50, [100, 300, 500, 700]]
    depth_m = 100 / np.float64([10, 12.5, 100 / 6, 25])
    assert np.allclose(found, HIGH_M * (depth_m[0] - depth_m) / (depth_m[0] - depth_m[-1]), atol=2e-5)
    assert np.array_equal(
        shaped(values, {"by": "depth"}, CAMERA), shaped(values, {**UNDISTORTED, "by": "depth"}, CAMERA)
    )
    by_disparity = shaped(values, UNDISTORTED, CAMERA)[50, [100, 300, 500, 700]]
    assert np.allclose(by_disparity, HIGH_M * (values[0, [100, 300, 500, 700]] - 10) / 15, atol=2e-5)


def test_cliff_becomes_a_ramp_of_the_slope_about_the_border():
    found = shaped(two_levels(), {"accent_m": 0, "slope": 1.0})[20]
    slopes = np.diff(found) / (WIDTH_M / 800)
    assert 0.95 < slopes.max() <= 1.0
    assert found[399:401].mean() == pytest.approx(HIGH_M / 2, rel=0.01)
    assert found[0] == pytest.approx(0, abs=1e-7) and found[-1] == pytest.approx(HIGH_M)
    ramp_m = np.ptp(np.flatnonzero((found > 0.05 * HIGH_M) & (found < 0.95 * HIGH_M))) * WIDTH_M / 800
    assert ramp_m == pytest.approx(0.9 * HIGH_M, rel=0.06)


@pytest.mark.parametrize(("width_m", "kept"), [(0.001, 0.3), (0.0015, 0.5), (0.002, 0.6)])
def test_narrow_bar_keeps_a_share_of_its_height(width_m, kept):
    found = shaped(bar(width_m))[100]
    height_m = found[395:406].max() - min(found[300:395].min(), found[406:500].min())
    assert kept * HIGH_M <= height_m < HIGH_M


def test_accent_raises_what_stands_before_and_lowers_what_lies_behind():
    values = np.full((300, 800), 10, np.float32)
    values[100:200, 200:400] = 14
    values[:, 700:] = 30
    with_accent, without = (shaped(values, {"accent_m": accent_m, "spread": 0}) for accent_m in (0.001, 0))
    raised = with_accent - without
    assert raised[150, 210] > 2e-4, "inside the border"
    assert np.abs(raised).max() <= 0.001 + 1e-6
    assert abs(raised[150, 300]) < 2e-5, "far inside"
    assert with_accent.min() >= 0 and with_accent.max() <= HIGH_M + 1e-7
    half = shaped(values, {"accent_m": 0.0003, "spread": 0}) - without
    assert 0 < half.max() <= 0.0003 + 1e-6


def test_unknown_places_are_filled_from_behind_or_cut():
    values = two_levels()
    values[:, 500:600] = np.nan
    values[:, 300:350] = np.nan
    filled, cut = shaped(values, {"accent_m": 0}), shaped(values, {"accent_m": 0}, holes="cut")
    assert np.allclose(filled[20, 520:580], HIGH_M, atol=1e-6), "both neighbours are near"
    assert cut[20, 550] == pytest.approx(0, abs=1e-6)
    assert np.abs(np.diff(cut, axis=1)).max() <= 1.1 * WIDTH_M / 800 * 1.001, "what is cut has slopes, too"
    assert filled[20, 325] == pytest.approx(0, abs=1e-6)


def test_given_scale_is_that_of_the_relief():
    values = two_levels()
    scale = ReliefScale(ValueRange(0, 40), STRAIGHT**2)
    found = shaped(values, {"accent_m": 0}, scale=scale)
    assert found[20, 10] == pytest.approx(HIGH_M / 16, rel=0.01)
    assert found[20, -10] == pytest.approx(HIGH_M / 4, rel=0.01)
