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


def steepest(height_m, pitch_m=PITCH_M):
    """The greatest rise over run between any two cells."""
    rows, columns = np.indices(height_m.shape).reshape(2, -1)
    run = np.hypot(rows[:, None] - rows, columns[:, None] - columns) * pitch_m
    rise = np.abs(height_m.reshape(-1, 1).astype(np.float64) - height_m.reshape(-1))
    return float((rise / np.where(run > 0, run, np.inf)).max())


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
def test_no_two_cells_are_farther_apart_than_the_slope_allows(height_m, slope):
    assert steepest(limit_slopes(height_m, PITCH_M, slope)) <= slope * (1 + 1e-3) + 1e-5


@given(HEIGHTS, SLOPES)
def test_limited_heights_are_those_of_all_pairs_of_cells(height_m, slope):
    expected = brute_force(brute_force(height_m, 2 * slope), slope)
    assert np.allclose(limit_slopes(height_m, PITCH_M, slope), expected, atol=1e-8, rtol=0)


@given(HEIGHTS, SLOPES)
def test_limiting_twice_is_limiting_once(height_m, slope):
    once = limit_slopes(height_m, PITCH_M, slope)
    assert np.allclose(limit_slopes(once, PITCH_M, slope), once, atol=1e-8, rtol=0)


@given(HEIGHTS, st.integers(0, 1000), SLOPES)
def test_change_of_the_heights_never_grows(height_m, seed, slope):
    changed = height_m + np.random.default_rng(seed).uniform(-1e-4, 1e-4, height_m.shape).astype(np.float32)
    apart = limit_slopes(height_m, PITCH_M, slope) - limit_slopes(changed, PITCH_M, slope)
    assert np.abs(apart).max() <= np.abs(height_m - changed).max() + 1e-8


@given(HEIGHTS, SLOPES)
def test_mirrored_heights_give_the_mirrored_surface(height_m, slope):
    limited = limit_slopes(height_m, PITCH_M, slope)
    for turned in (np.flipud, np.fliplr, np.transpose):
        again = limit_slopes(np.ascontiguousarray(turned(height_m)), PITCH_M, slope)
        assert np.allclose(turned(again), limited, atol=1e-8, rtol=0)


@given(HEIGHTS, SLOPES)
def test_negated_heights_give_the_negated_surface(height_m, slope):
    """Neither what stands out nor what lies deep is kept at the cost of the other."""
    assert np.array_equal(limit_slopes(-height_m, PITCH_M, slope), -limit_slopes(height_m, PITCH_M, slope))


def test_plane_under_the_slope_stays_itself():
    plane = (np.add.outer(0.3 * np.arange(20), 0.4 * np.arange(30)) * PITCH_M).astype(np.float32)
    assert np.allclose(limit_slopes(plane, PITCH_M, 0.5 * CHAMFER), plane, atol=1e-9)
    assert np.abs(limit_slopes(plane, PITCH_M, 0.4) - plane).max() > 1e-5, "steeper than the limit"


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


def test_heights_given_stay_as_they_are():
    step = np.float32([[0, 0, 0.01, 0.01]])
    limit_slopes(step, PITCH_M, 1.0)
    assert step.tolist() == np.float32([[0, 0, 0.01, 0.01]]).tolist()


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (7, 1), (2, 2)])
def test_level_ground_of_any_shape_stays_level(shape):
    level = np.full(shape, 0.004, np.float32)
    assert np.array_equal(limit_slopes(level, PITCH_M, 1.0), level)
