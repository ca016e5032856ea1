"""If one of these fails, a relief is too steep, too low or untrue to the depths that it is made of."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tangible_core.data import Calibration, DisparityMap
from tangible_core.relief import ReliefChoice, ReliefScale, limit_slopes, shape_relief
from tangible_core.relief.shaping import BINS, GRAIN_HIGH_M, STEEPEST, STRAIGHT, apply_tones, relief_tones
from tangible_core.relief.slope_limit import CHAMFER
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
    step = np.zeros((3, 60), np.float32)
    step[:, 30:] = 0.002
    limited = limit_slopes(step, PITCH_M, 2.0 * CHAMFER)
    assert np.allclose(np.diff(limited[1])[25:34], 2.0 * PITCH_M, atol=1e-8)
    assert limited[1, 29:31].mean() == pytest.approx(0.001)
    assert np.allclose(limited[:, :25], 0, atol=1e-9) and np.allclose(limited[:, -25:], 0.002, atol=1e-9)
    step = np.float32([[0, 0, 0.01, 0.01]])
    assert limit_slopes(step, PITCH_M, 0) is step


@pytest.mark.parametrize(("width_m", "kept"), [(0.001, 0.3), (0.0015, 0.5), (0.002, 0.6)])
def test_narrow_bar_keeps_a_share_of_its_height(width_m, kept):
    found = shaped(bar(width_m))[100]
    height_m = found[395:406].max() - min(found[300:395].min(), found[406:500].min())
    assert kept * HIGH_M <= height_m < HIGH_M


def test_unknown_places_are_filled_or_cut_and_accents_raise():
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


PITCH_M = 1e-4
HEIGHTS = hnp.arrays(
    np.float32, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.floats(0, 0.0078125, width=32)
)
SLOPES = st.floats(0.2, 5)


def brute_force(height_m, slope):
    """The middle of the two envelopes, by all pairs of cells at chamfer lengths."""
    rows, columns = np.indices(height_m.shape).reshape(2, -1)
    long, short = (
        pick(np.abs(rows[:, None] - rows), np.abs(columns[:, None] - columns)) for pick in (np.maximum, np.minimum)
    )
    length = np.where(
        2 * short <= long, (long - 2 * short) + short * 5**0.5, (2 * short - long) * 2**0.5 + (long - short) * 5**0.5
    )
    bound = length * (slope * PITCH_M / CHAMFER)
    flat = height_m.reshape(-1).astype(np.float64)
    return (((flat + bound).min(axis=1) + (flat - bound).max(axis=1)) / 2).reshape(height_m.shape)


@given(HEIGHTS, SLOPES)
def test_limited_heights_are_those_of_all_pairs_of_cells(height_m, slope):
    expected = brute_force(brute_force(height_m, 2 * slope), slope)
    assert np.allclose(limit_slopes(height_m, PITCH_M, slope), expected, atol=1e-8, rtol=0)


@given(HEIGHTS, SLOPES)
def test_negated_heights_give_the_negated_surface(height_m, slope):
    assert np.array_equal(limit_slopes(-height_m, PITCH_M, slope), -limit_slopes(height_m, PITCH_M, slope))


UNIT = st.floats(0, 1, width=32)
MAPS = hnp.arrays(np.float32, st.tuples(st.integers(1, 12), st.integers(1, 12)), elements=UNIT)


def steps(*values, rows=10, width=10):
    """Level stripes of these values."""
    return np.repeat(np.float32(values), width)[None].repeat(rows, axis=0)


@given(MAPS, st.floats(0, 1))
def test_tones_rise_from_zero_to_one_within_their_slopes(nearness, share):
    tones = relief_tones(nearness, share)
    slopes = np.diff(tones) * BINS
    assert tones[0] == 0 and tones[-1] == pytest.approx(1)
    assert slopes.min() >= 1 - share - 1e-9
    assert slopes.max() <= 1 + share * STEEPEST + 1e-9


@given(MAPS, st.floats(0, 0.99), UNIT, UNIT)
def test_order_of_depths_is_kept(nearness, share, one, other):
    low, high = sorted([one, other])
    heights = apply_tones(np.float32([[low, high]]), relief_tones(nearness, share))[0]
    assert heights[0] <= heights[1]
    if high - low > 1e-4:
        assert heights[1] - heights[0] > 0.9 * (1 - share) * (high - low) - 1e-6


def test_each_border_counts_once_however_high_it_is():
    slopes = np.diff(relief_tones(steps(0.0, 0.6, 0.6, 0.8, 0.8), 0.2)) - 0.8 / BINS
    assert slopes[160:200].mean() == pytest.approx(3 * slopes[10:150].mean(), rel=0.05)


@pytest.mark.parametrize("nearness", [np.zeros((1, 1)), np.full((9, 9), 0.4), np.linspace(0, 1, 400).reshape(1, -1)])
def test_without_borders_tones_are_straight(nearness):
    assert np.allclose(relief_tones(nearness.astype(np.float32), 0.9), STRAIGHT)


@pytest.mark.parametrize(("step", "straight"), [(0.027, True), (0.033, False)])
def test_difference_of_a_border_is_at_least_three_hundredths(step, straight):
    assert np.allclose(relief_tones(steps(0.5, 0.5 + step), 0.9), STRAIGHT) == straight


def test_values_between_places_are_interpolated():
    tones = STRAIGHT**2
    values = np.float32([[0, 0.5 / BINS, 0.25, 1]])
    assert np.allclose(apply_tones(values, tones), [[0, tones[1] / 2, 1 / 16, 1]], atol=1e-7)
