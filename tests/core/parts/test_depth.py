"""If one of these fails, parts are at other heights than their depths, or one wrong depth flattens all others."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from tangible_core.data import DisparityMap, PartMap, SegmentMap
from tangible_core.parts import depth_heights, find_parts
from tangible_core.parts.depth import part_medians

VALUES = st.one_of(st.floats(width=32), st.sampled_from([0.0, -0.0, 1.0, -1.0, np.nan, np.inf, -np.inf]))


def stripes(*disparities_px: float, rows: int = 20, width: int = 10) -> tuple[PartMap, DisparityMap]:
    """Return parts side by side, each with one disparity."""
    labels = np.broadcast_to(np.arange(len(disparities_px)).repeat(width), (rows, width * len(disparities_px)))
    parts = find_parts(SegmentMap(labels.astype(np.int32)))
    return parts, DisparityMap(np.float32(disparities_px)[parts.labels])


@example(np.zeros((5, 6), np.int32), np.arange(30, dtype=np.float32).reshape(5, 6))  # an even number: two in the middle
@given(arrays.arrays(np.int32, (5, 6), elements=st.integers(0, 2)), arrays.arrays(np.float32, (5, 6), elements=VALUES))
def test_medians_are_those_of_the_finite_values_of_each_part(labels, values):
    parts = find_parts(SegmentMap(labels))
    medians, known = part_medians(parts, values)
    for part in range(parts.count):
        finite = values[(parts.labels == part) & np.isfinite(values)].astype(np.float64)
        assert known[part] == finite.size
        assert np.array_equal(medians[part], np.median(finite) if finite.size else np.nan, equal_nan=True)


def test_heights_are_linear_in_disparity_from_the_farthest_to_the_nearest():
    assert depth_heights(*stripes(30, 10, 20), 0.004).heights_m == pytest.approx((0.004, 0, 0.002))


def test_speck_with_a_wrong_depth_does_not_flatten_the_others():
    parts, disparity = stripes(10, 20, 30)
    labels, values = parts.labels.copy(), disparity.disparity_px.copy()
    labels[5, 5], values[5, 5] = 3, 900
    heights = depth_heights(find_parts(SegmentMap(labels)), DisparityMap(values), 0.004)
    assert sorted(heights.heights_m) == pytest.approx([0, 0.002, 0.004, 0.004])


@pytest.mark.parametrize(("columns", "clipped"), [(4, True), (6, False)])
def test_heights_run_between_what_has_half_a_percent_of_the_picture_on_either_side(columns: int, clipped: bool):
    """Of 1000 columns, so many are much farther and so many much nearer than all others."""
    labels = np.searchsorted([columns, 300, 600, 1000 - columns], np.arange(1000), side="right")
    parts = find_parts(SegmentMap(np.tile(labels, (3, 1)).astype(np.int32)))
    disparity = DisparityMap(np.float32([-900, 10, 20, 40, 1000])[parts.labels])
    expected = (0, 0, 1 / 3, 1, 1) if clipped else (0, 91 / 190, 92 / 190, 94 / 190, 1)
    assert depth_heights(parts, disparity, 0.004).heights_m == pytest.approx([0.004 * each for each in expected])


def test_unknown_parts_lie_as_far_as_the_farthest_of_their_neighbours_one_after_the_other():
    """Three unknown parts in a row between 40 and 20 px, and one that is beside 10 and 30 px."""
    heights = depth_heights(*stripes(40, np.nan, np.nan, np.nan, 20, 30, np.nan, 10), 0.003).heights_m
    assert heights == pytest.approx((0.003, 0.003, 0.001, 0.001, 0.001, 0.002, 0, 0))


@pytest.mark.parametrize("disparity_px", [7.0, np.nan])
def test_equal_or_unknown_depths_give_heights_of_zero(disparity_px):
    assert depth_heights(*stripes(disparity_px, disparity_px), 0.004).heights_m == (0, 0)
