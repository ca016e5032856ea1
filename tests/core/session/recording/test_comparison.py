"""Comparison of recordings, with analytic forces: a study reads a difference that is none, or overlooks one."""

import math

import numpy as np
import pytest

from tangible_core.errors import ConfigError
from tangible_core.session import Recording, compare_recordings
from tangible_core.session.recording.replay import MAX_COMPARED

DEEP_M, WIDE_M = 1e-3, 0.1


def press(stiffness_n_per_m: float, friction_n: float = 0.0, ticks: int = 2001, away_m: float = 0.0) -> Recording:
    """Along x and back, pressed twice into a spring as deep as a sine, against a friction of constant force."""
    way = np.linspace(0, 2, ticks)
    x, depth_m = WIDE_M * (1 - np.abs(1 - way)), DEEP_M * np.abs(np.sin(np.pi * way))
    ahead = np.where(way < 1, 1.0, -1.0)
    zero = np.zeros(ticks)
    return Recording.of(
        time_s=way,
        position_m=np.column_stack([x, zero + away_m, -depth_m]),
        velocity_m_per_s=np.column_stack([WIDE_M * ahead, zero, zero]),
        force_n=np.column_stack([-friction_n * ahead, zero, stiffness_n_per_m * depth_m]),
    )


def test_comparison_of_springs_at_different_speeds_is_exact():
    """F = k d: the forces differ by (k2 - k1) d, whose root mean square over a sine is its height / sqrt(2)."""
    found = compare_recordings(press(1000), press(600, ticks=901, away_m=1e-4))
    assert found["error_n"] == pytest.approx(400 * DEEP_M / math.sqrt(2), rel=0.01)
    assert found["error_percent"] == pytest.approx(40, abs=0.5)
    assert (found["first_peak_force_n"], found["second_peak_force_n"]) == pytest.approx((1.0, 0.6), rel=1e-3)
    assert found["direction_deg"] == pytest.approx(0, abs=1e-6)
    assert (found["compared"], found["compared_share"]) == (2001, 1.0)
    step_m = 2 * WIDE_M / 900  # of the second: a tick of the first lies a quarter of it away in the median
    assert found["apart_m"] == pytest.approx(math.hypot(1e-4, step_m / 4), rel=0.01)
    assert found["first_contact_share"] == pytest.approx(1, abs=0.01)
    assert found["first_work_j"] == pytest.approx(0, abs=1e-5)  # a spring gives back what it takes
    assert (found["first_seconds"], found["second_ticks"]) == (2.0, 901)


def test_comparison_pairs_ticks_of_the_same_direction():
    """Friction turns with the direction: compared with the way there, it would differ by twice its force."""
    found = compare_recordings(press(0, 0.3), press(0, 0.3, ticks=1501))
    assert found["error_n"] == pytest.approx(0, abs=0.05)
    assert found["first_work_j"] == pytest.approx(-0.3 * 2 * WIDE_M, rel=0.01)
    assert compare_recordings(press(0, 0.3), press(0, 0.1))["error_n"] == pytest.approx(0.2, rel=0.02)


def test_comparison_of_empty_unknown_and_long_recordings_works():
    empty, one = Recording(np.empty((0, 17))), press(1000)
    assert compare_recordings(empty, one)["compared"] == compare_recordings(one, empty)["compared"] == 0
    lost = one.rows.copy()
    lost[:1000, 2] = np.nan
    assert compare_recordings(Recording(lost), one)["compared"] == 1001
    assert compare_recordings(one, Recording(lost))["compared"] > 1000
    assert compare_recordings(press(1000, ticks=2 * MAX_COMPARED), one)["compared"] == MAX_COMPARED
    with pytest.raises(ConfigError, match="near_m: is 0; it must be positive"):
        compare_recordings(one, one, 0)
