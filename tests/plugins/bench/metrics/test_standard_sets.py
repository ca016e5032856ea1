"""Measures of disparity as standard sets define them: errors, sparsification, and pixels that both views show."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_bench.metrics.standard_sets import (
    LEFT,
    benchmark_errors,
    sparsification_curve,
    sparsification_errors,
    visible_pixels,
)
from tangible_core.errors import PictureError
from tangible_core.metrics import disparity_errors

NAN = np.nan


@pytest.fixture(scope="module")
def maps() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Make an estimate, its truth with a fifth unknown, and a foreground."""
    random = np.random.default_rng(17)
    truth = random.uniform(2, 120, (60, 80)).astype(np.float32)
    found = (truth + random.normal(0, 4, truth.shape)).astype(np.float32)
    truth[random.random(truth.shape) < 0.2] = NAN
    return found, truth, random.random(truth.shape) < 0.3


@pytest.mark.parametrize("bound", [0.5, 1.0, 2.0, 4.0])
def test_bad_pixels_and_d1_equal_those_of_kornia(maps, bound: float):
    import torch
    from kornia import metrics

    found, truth, foreground = maps
    mine = disparity_errors(found, truth) | benchmark_errors(found, truth, foreground)
    known = np.isfinite(truth)
    maps_of = [torch.from_numpy(np.nan_to_num(each)) for each in (found, truth)]
    for name, part in (("d1", known), ("d1_bg", known & ~foreground), ("d1_fg", known & foreground)):
        theirs = metrics.kitti_d1_error(*maps_of, valid_mask=torch.from_numpy(part))
        assert mine[name] == pytest.approx(100 * float(theirs), abs=1e-4)
    mask = torch.from_numpy(known)
    for name, share in ((f"bad{bound:g}", bound), ("bad3", 3.0)):
        theirs = metrics.mean_bad_pixel_error(*maps_of, threshold=share, valid_mask=mask)
        assert mine[name] == pytest.approx(100 * float(theirs), abs=1e-4)
    average = metrics.mean_absolute_disparity_error(*maps_of, valid_mask=mask)
    rms = metrics.root_mean_squared_disparity_error(*maps_of, valid_mask=mask)
    assert (mine["average_px"], mine["rms_px"]) == pytest.approx((float(average), float(rms)), rel=1e-5)
    assert 5 < mine["d1_bg"] < 95 and mine["d1_bg"] != mine["d1_fg"] != mine["d1"]


def test_quantiles_and_counts_are_over_known_pixels(maps):
    found, truth, foreground = maps
    found = found.copy()
    found[:30] = NAN
    mine = benchmark_errors(found, truth, foreground)
    error = np.abs(found.astype(float) - truth)
    for share in (50, 90, 95, 99):
        assert mine[f"a{share}_px"] == pytest.approx(np.nanpercentile(error, share))
    known = np.isfinite(truth)
    assert mine["invalid"] == pytest.approx(100 * np.isnan(found[known]).mean())
    assert mine["invalid"] == pytest.approx(100 - disparity_errors(found, truth)["density"])
    assert (mine["pixels"], mine["pixels_fg"]) == (known.sum(), (known & foreground).sum())
    assert mine["pixels_bg"] + mine["pixels_fg"] == mine["pixels"]


@pytest.mark.parametrize(
    ("found", "truth", "d1", "bad3"),
    [
        (13.0, 10.0, 0, 0),  # exactly at the bound
        (13.1, 10.0, 100, 100),
        (104.9, 100.0, 0, 100),  # over 3 px, within 5 %
        (105.1, 100.0, 100, 100),
        (NAN, 10.0, 100, 100),
        (np.inf, 10.0, 100, 100),
        (10.0, NAN, NAN, NAN),
    ],
)
def test_outlier_is_off_by_more_than_3_px_and_5_percent(found, truth, d1, bad3):
    mine = benchmark_errors(np.float32([[found]]), np.float32([[truth]]))
    assert (mine["d1"], mine["bad3"]) == pytest.approx((d1, bad3), nan_ok=True)
    assert np.isnan(mine["d1_fg"]) and np.isnan(mine["d1_bg"]) and mine["pixels_fg"] == 0


def curve(figures: dict[str, float], end: str = "") -> list[float]:
    return [figures[f"left_{removed}{end}"] for removed in LEFT]


@pytest.mark.parametrize(
    ("confidence", "wrong", "expected"),
    [
        ([0.1, 0.9, 0.5, 0.3], [1, 0, 1, 0], [0, 1 / 2, 1 / 3, 1 / 2]),
        ([0.9, 0.5, 0.5, 0.5], [0, 1, 0, 0], [0, (1 / 3) / 2, (2 / 3) / 3, 1 / 4]),  # a third with each of three equals
    ],
)
def test_curve_equals_that_computed_by_hand(confidence: list[float], wrong: list[int], expected: list[float]):
    np.testing.assert_allclose(sparsification_curve(np.array(confidence), np.array(wrong, bool)), expected)


def test_areas_of_orders_are_exact_and_zero_without_wrong_pixels():
    """Four pixels, one of them 3 px off: only the whole map has it in the best order, every part in the worst."""
    truth, found = np.zeros((2, 2), np.float32), np.float32([[0, 3], [1, 2]])
    best = sparsification_errors(found, np.float32([[1, 0], [1, 1]]), truth)
    worst = sparsification_errors(found, np.float32([[0, 1], [0, 0]]), truth)
    none = sparsification_errors(found, np.ones((2, 2), np.float32), truth)
    quarter = 100 * (1 / 4) / 4
    assert (best["ausc"], best["ausc_by_oracle"]) == pytest.approx((quarter, 1))
    area = 100 * (1 + 1 / 2 + 1 / 3 + 1 / 4) / 4
    assert (worst["ausc"], worst["ausc_by_oracle"]) == pytest.approx((area, area / quarter))
    assert none["ausc"] == pytest.approx(disparity_errors(found, truth)["bad2"])
    found = np.float32([[0, NAN, 9, 0]])
    truth = np.float32([[0, 0, NAN, 0]])
    figures = sparsification_errors(found, np.float32([[0.1, 1, 1, 0]]), truth)
    assert (figures["ausc"], figures["ausc_by_oracle"]) == pytest.approx((100 * (1 / 3) / 3, 1))
    zero, sure = np.zeros((2, 2), np.float32), np.ones((2, 2), np.float32)
    right = sparsification_errors(zero, sure, zero)
    assert right["ausc"] == 0
    assert np.isnan(right["ausc_by_oracle"])
    assert all(np.isnan(value) for value in sparsification_errors(zero, sure, np.full((2, 2), NAN)).values())


def test_curve_of_the_best_order_falls_to_zero():
    """Twenty of 100 pixels are wrong: 20 - r of the 100 - r that are left, and then none."""
    truth = np.zeros((10, 10), np.float32)
    found = np.zeros((10, 10), np.float32)
    found[:2] = 3
    by_hand = [100 * max(0, 20 - removed) / (100 - removed) for removed in LEFT]
    figures = sparsification_errors(found, -found, truth)
    assert curve(figures) == pytest.approx(by_hand)
    assert curve(figures, "_by_oracle") == pytest.approx(by_hand)
    unsure = sparsification_errors(found, np.ones_like(found), truth)
    assert curve(unsure) == pytest.approx([20] * len(LEFT))
    assert curve(unsure, "_by_oracle") == pytest.approx(by_hand)
    one = sparsification_errors(np.float32([[3]]), np.float32([[1]]), np.float32([[0]]))
    assert curve(one) == [100] * len(LEFT), "it keeps one pixel"


@pytest.mark.usefixtures("unchecked_shapes")
def test_maps_of_different_size_are_refused():
    with pytest.raises(PictureError, match=r"\(2, 2\) and its truth \(2, 3\)"):
        sparsification_errors(np.ones((2, 2)), np.ones((2, 2)), np.ones((2, 3)))


@given(st.integers(1, 12), st.integers(0, 12))
def test_strip_behind_a_step_is_hidden_as_wide_as_the_jump(jump: int, far: int):
    """The strip is left of a nearer surface, and at the left border."""
    edge, width = 40, 64
    truth = np.full((3, width), far, np.float64)
    truth[:, edge:] = far + jump
    hidden = ~visible_pixels(truth)
    expected = np.zeros(width, np.bool_)
    expected[:far] = True
    if jump > 1:  # less is a slope
        expected[edge - jump : edge] = True
    np.testing.assert_array_equal(hidden, np.tile(expected, (3, 1)))


def test_surfaces_hide_what_is_behind_them_and_bars_their_own_width():
    """The bar at 40 jumps over the wall: seen at 40 - 12 it hides the wall of 28 + 2, and none between."""
    truth = np.full((1, 64), 2.0)
    truth[0, 40:43] = 12
    hidden = np.flatnonzero(~visible_pixels(truth)[0])
    assert hidden.tolist() == [0, 1, 30, 31, 32]
    down = np.where(np.arange(64) < 30, 9.0, 2.0)[None]
    np.testing.assert_array_equal(visible_pixels(down)[0], np.arange(64) >= 9)
    assert np.flatnonzero(~visible_pixels(np.full((1, 9), -2.0))[0]).tolist() == [7, 8], "behind the screen"
    truth = np.full((1, 30), np.nan, np.float32)
    truth[0, :14] = 0
    truth[0, 20:] = 20 - 0.5 * np.arange(10)
    assert np.flatnonzero(visible_pixels(truth)[0]).tolist() == list(range(20, 30))
    for slope in (-0.45, -0.2, 0.3, 0.9):
        truth = 30 + slope * np.arange(60.0)[None]
        seen = np.arange(60) - truth[0] >= -0.5
        np.testing.assert_array_equal(visible_pixels(truth)[0], seen)
    truth = np.full((1, 20), 2.0)
    truth[0, 10:] = NAN
    np.testing.assert_array_equal(np.flatnonzero(visible_pixels(truth)[0]), np.arange(2, 10))
