"""If one of these fails, heights go to depths without borders, or the order of depths is lost."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tangible_core.relief.shaping import BINS, STEEPEST, STRAIGHT, apply_tones, relief_tones

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
