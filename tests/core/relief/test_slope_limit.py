"""If one of these fails, a cliff is steeper than a hand can climb, or a slope that it can climb is changed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tangible_core.relief import limit_slopes
from tangible_core.relief.slope_limit import CHAMFER

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


def test_step_becomes_a_ramp_about_its_middle():
    step = np.zeros((3, 60), np.float32)
    step[:, 30:] = 0.002
    limited = limit_slopes(step, PITCH_M, 2.0 * CHAMFER)
    assert np.allclose(np.diff(limited[1])[25:34], 2.0 * PITCH_M, atol=1e-8)
    assert limited[1, 29:31].mean() == pytest.approx(0.001)
    assert np.allclose(limited[:, :25], 0, atol=1e-9) and np.allclose(limited[:, -25:], 0.002, atol=1e-9)


def test_slope_of_zero_keeps_cliffs():
    step = np.float32([[0, 0, 0.01, 0.01]])
    assert limit_slopes(step, PITCH_M, 0) is step
