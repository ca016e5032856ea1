"""Sparsification: the share of wrong pixels as the least confident ones are removed."""

import numpy as np
import pytest

from tangible_bench.metrics.standard_sets import LEFT, sparsification_curve, sparsification_errors
from tangible_core.errors import PictureError
from tangible_core.metrics import disparity_errors

NAN = np.nan


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


def test_areas_of_best_worst_and_constant_order_are_exact():
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


def test_missing_estimate_is_wrong_and_least_confident():
    found = np.float32([[0, NAN, 9, 0]])
    truth = np.float32([[0, 0, NAN, 0]])
    figures = sparsification_errors(found, np.float32([[0.1, 1, 1, 0]]), truth)
    assert (figures["ausc"], figures["ausc_by_oracle"]) == pytest.approx((100 * (1 / 3) / 3, 1))


def test_area_without_wrong_pixels_is_zero_and_without_truth_nan():
    zero, sure = np.zeros((2, 2), np.float32), np.ones((2, 2), np.float32)
    right = sparsification_errors(zero, sure, zero)
    assert right["ausc"] == 0
    assert np.isnan(right["ausc_by_oracle"])
    assert all(np.isnan(value) for value in sparsification_errors(zero, sure, np.full((2, 2), NAN)).values())


@pytest.mark.usefixtures("unchecked_shapes")
def test_maps_of_different_size_are_refused():
    with pytest.raises(PictureError, match=r"\(2, 2\) and its truth \(2, 3\)"):
        sparsification_errors(np.ones((2, 2)), np.ones((2, 2)), np.ones((2, 3)))
