"""Reliefs of maps whose answer is known."""

import numpy as np
import pytest

from tangible_core import Pipeline, Scene
from tangible_core.data import Calibration, DisparityMap
from tangible_core.errors import GeometryError
from tangible_core.relief import ReliefChoice, ReliefScale, relief_scale, shape_relief
from tangible_core.relief.shaping import CELL_M, GRAIN_HIGH_M
from tangible_core.relief.tones import STRAIGHT
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


def test_depth_suits_five_millimetres_rounded_by_a_quarter():
    assert SIZE[:3] == (0.08, HIGH_M, 0.00025)


@pytest.mark.parametrize("camera", [None, CAMERA])
@pytest.mark.parametrize("holes", ["fill", "cut"])
def test_plain_choice_is_the_linear_relief(camera, holes):
    values = np.random.default_rng(0).uniform(1, 9, (12, 17)).astype(np.float32)
    values[3:5, 4:9] = np.nan
    found = shaped(values, {**PLAIN, "by": "depth"}, camera, smooth_m=0, holes=holes)
    expected = geometry.make_relief(DisparityMap(values), camera, WIDTH_M, HIGH_M, holes).height_m
    assert np.allclose(found, expected, atol=1e-9)
    assert not np.array_equal(found, shaped(values, smooth_m=0))


def test_finer_cells_are_kept_where_less_is_rounded():
    """Pixels of 0.05 mm, of which 0.1 mm are kept under the usual rounding."""
    values = np.random.default_rng(6).uniform(1, 9, (20, 1600)).astype(np.float32)
    relief = geometry.make_relief(DisparityMap(values), None, WIDTH_M, HIGH_M)
    found = shaped(values, PLAIN, smooth_m=0.0001)
    assert np.allclose(found, geometry.smooth(relief, 0.0001).height_m, atol=1e-6)
    assert shaped(values, PLAIN).std() < 0.2 * relief.height_m.std()


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


def test_uncalibrated_depth_is_linear_in_disparity():
    values = two_levels()
    assert np.array_equal(shaped(values, {**PLAIN, "by": "depth"}), shaped(values, PLAIN))


def test_cliff_becomes_a_ramp_of_the_slope_about_the_border():
    found = shaped(two_levels(), {"accent_m": 0, "slope": 1.0})[20]
    slopes = np.diff(found) / (WIDTH_M / 800)
    assert 0.95 < slopes.max() <= 1.0
    assert found[399:401].mean() == pytest.approx(HIGH_M / 2, rel=0.01)
    assert found[0] == pytest.approx(0, abs=1e-7) and found[-1] == pytest.approx(HIGH_M)
    ramp_m = np.ptp(np.flatnonzero((found > 0.05 * HIGH_M) & (found < 0.95 * HIGH_M))) * WIDTH_M / 800
    assert ramp_m == pytest.approx(0.9 * HIGH_M, rel=0.06)


@pytest.mark.parametrize("columns", [200, 741, 1600])
def test_no_place_of_noise_is_steeper_than_the_slope(columns):
    values = np.random.default_rng(1).uniform(0, 100, (columns // 4, columns)).astype(np.float32)
    found, pitch_m = shaped(values, {"slope": 1.1}), WIDTH_M / columns
    assert np.abs(np.diff(found, axis=1)).max() <= 1.1 * pitch_m * 1.001
    assert np.abs(np.diff(found, axis=0)).max() <= 1.1 * pitch_m * 1.001
    assert np.abs(found[1:, 1:] - found[:-1, :-1]).max() <= 1.1 * pitch_m * 2**0.5 * 1.001


@pytest.mark.parametrize(("width_m", "kept"), [(0.001, 0.3), (0.0015, 0.5), (0.002, 0.6)])
def test_narrow_bar_keeps_a_share_of_its_height(width_m, kept):
    found = shaped(bar(width_m))[100]
    height_m = found[395:406].max() - min(found[300:395].min(), found[406:500].min())
    assert kept * HIGH_M <= height_m < HIGH_M


def test_same_scene_at_twice_the_pixels_is_the_same_relief():
    y, x = np.mgrid[:500, :800] / 500
    scene = (10 + 3 * x + 8 * (np.hypot(x - 0.5, y - 0.5) < 0.2) + 5 * (np.abs(x - 1.1) < 0.06)).astype(np.float32)
    large = np.kron(scene, np.ones((2, 2), np.float32)) * 2
    one, other = shaped(scene), shaped(large).reshape(500, 2, 800, 2).mean(axis=(1, 3))
    assert np.sqrt(np.mean((one - other) ** 2)) <= 40e-6


def test_mirrored_map_gives_the_mirrored_relief():
    values = np.random.default_rng(2).uniform(0, 9, (40, 60)).astype(np.float32)
    for turned in (np.flipud, np.fliplr):
        assert np.allclose(turned(shaped(turned(values).copy())), shaped(values), atol=1e-7)


def test_accent_raises_what_stands_before_and_lowers_what_lies_behind():
    """Two blocks of middle depth before ground, and something nearer far away."""
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


def test_noise_is_taken_out_and_a_step_stays():
    noise_px = 10 * 0.3 * GRAIN_HIGH_M / HIGH_M
    values = two_levels() + np.random.default_rng(3).normal(0, noise_px, (40, 800)).astype(np.float32)
    plain = {**PLAIN, "slope": 0}
    rough, calm = (shaped(values, {**plain, "grain_m": grain_m}, smooth_m=1e-9) for grain_m in (0, 0.0003))
    level = np.s_[:, 50:350]
    assert calm[level].std() < 0.6 * rough[level].std()
    assert abs((calm[20, 420] - calm[20, 380]) - HIGH_M) < 0.04 * HIGH_M


def test_unknown_places_are_filled_from_behind_or_cut():
    values = two_levels()
    values[:, 500:600] = np.nan
    values[:, 300:350] = np.nan
    filled, cut = shaped(values, {"accent_m": 0}), shaped(values, {"accent_m": 0}, holes="cut")
    assert np.allclose(filled[20, 520:580], HIGH_M, atol=1e-6), "both neighbours are near"
    assert cut[20, 550] == pytest.approx(0, abs=1e-6)
    assert np.abs(np.diff(cut, axis=1)).max() <= 1.1 * WIDTH_M / 800 * 1.001, "what is cut has slopes, too"
    assert filled[20, 325] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("shape", [(1, 1), (1, 30), (30, 1), (3, 2)])
@pytest.mark.parametrize("value", [0.0, -4.0, 1e30])
def test_constant_map_of_any_shape_is_flat(shape, value):
    assert not shaped(np.full(shape, value)).any()


def test_map_of_nothing_known_is_refused():
    with pytest.raises(GeometryError, match="no depth is known"):
        shaped(np.full((4, 4), np.nan))


def test_spikes_stay_within_the_relief():
    values = np.full((60, 90), 10.0)
    values[30, 40], values[10, 10], values[50, 80] = 1e6, 1e30, -1e6
    found = shaped(values)
    assert np.isfinite(found).all()
    assert found.min() >= 0 and found.max() <= HIGH_M * (1 + 1e-6)


def test_given_scale_is_that_of_the_relief():
    """A thing that stands still keeps its height, whatever else is in the frame."""
    values = two_levels()
    scale = ReliefScale(ValueRange(0, 40), STRAIGHT**2)
    found = shaped(values, {"accent_m": 0}, scale=scale)
    assert found[20, 10] == pytest.approx(HIGH_M / 16, rel=0.01)
    assert found[20, -10] == pytest.approx(HIGH_M / 4, rel=0.01)


def test_scale_of_a_map_makes_the_relief_of_the_map():
    values = np.random.default_rng(4).uniform(1, 9, (50, 70)).astype(np.float32)
    disparity, choice = DisparityMap(values), ReliefChoice()
    scale = relief_scale(disparity, None, WIDTH_M, choice)
    assert np.array_equal(shaped(values, scale=scale), shaped(values))
    assert scale.spans == geometry.nearness_range(disparity, None)
    assert np.array_equal(relief_scale(disparity, None, WIDTH_M, ReliefChoice(by="depth")).tones, STRAIGHT)


def test_noise_between_frames_stays_under_what_is_felt():
    """A quarter of a pixel of noise moves the surface by less than the 29 um that are felt at 3.2 mm."""
    values, random = two_levels(columns=400, rows=200, low=20, high=60), np.random.default_rng(5)
    frames = [values + random.normal(0, 0.25, values.shape).astype(np.float32) for _ in range(2)]
    scale = relief_scale(DisparityMap(frames[0]), None, WIDTH_M, ReliefChoice())
    one, other = (shaped(each, scale=scale) for each in frames)
    assert 1e-7 < np.sqrt(np.mean((one - other) ** 2)) < 29e-6


def test_rounding_comes_last_and_is_that_of_the_workspace():
    """A relief of an old file is still smoothed by as much as the file says."""
    found = shaped(two_levels(), {**PLAIN}, smooth_m=0.002)[20]
    at = (np.arange(800) - 399.5) * WIDTH_M / 800
    wave = np.interp([0.1587, 0.5, 0.8413], found / HIGH_M, at)
    assert np.allclose(wave, [-0.002, 0, 0.002], atol=4e-5)
    assert CELL_M <= WIDTH_M / 800


@pytest.mark.parametrize("choice", [{}, {"spread": 0}, {"accent_m": 0}, "depth", UNDISTORTED])
def test_outcome_tells_that_heights_are_spread_and_the_cure(choice):
    picture = np.zeros((40, 60, 3), np.uint8)
    scene = Scene.photo(picture, disparity=two_levels(columns=60, rows=40))
    pipeline = Pipeline(scene, relief=choice, cached=False)
    assert pipeline.relief.height_m.max() > 0.004
    [why] = [each.why for each in pipeline.outcomes if each.product == "relief"]
    assert ("`relief: depth` keeps true proportions" in why) == (choice not in ("depth", UNDISTORTED))
