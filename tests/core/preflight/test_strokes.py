"""Strokes of a simulated hand. Otherwise a wall or a sudden force would be found on a safe surface, or missed."""

import numpy as np
import pytest

from flights import fly, level, of, shape
from tangible_core import load_method
from tangible_core.preflight.checks.slopes import cliffs
from tangible_core.preflight.strokes import DAMPING_N_S_PER_M, LINES, MAX_TICKS, SIDEWAYS, stroke

PERIOD_S, SPEED = 0.001, 0.12


def strokes_of(surface, law="proxy", press_n=1.5, speed=SPEED, **options):
    return stroke(load_method("render", law)(**options).touch(surface), surface, press_n, speed, PERIOD_S)


def test_level_ground_answers_the_press_and_holds_nobody_up():
    found = strokes_of(level())
    assert found.force_n[found.force_n.size // 2 :] == pytest.approx(1.5, abs=0.05)
    assert not found.held_up.any()
    assert np.abs(found.rise_n).max() < 0.01


def test_each_line_is_stroked_at_the_speed_of_the_hand():
    found = strokes_of(level())
    assert (
        found.force_n.size
        == found.rise_n.size
        == found.held_up.size
        == 2 * LINES * round(0.92 * 0.08 / SPEED * 1000 + 0.5)
    )
    assert strokes_of(level(), speed=0.001).force_n.size == 2 * LINES * MAX_TICKS


def test_hand_climbs_a_slope_with_the_push_of_the_formula():
    """Without friction, slope 1 is climbed with a push of its press and its damping: sqrt(2) of them in all."""
    found = strokes_of(shape(lambda x, y: np.abs(x)), speed=0.04).force_n.reshape(2 * LINES, -1)
    uphill_n = np.median(found[0, 800:900])
    assert uphill_n == pytest.approx((1.5 + DAMPING_N_S_PER_M * 0.04) * 2**0.5, rel=0.08)


def test_force_stays_within_what_the_hand_can_give():
    """A wall is pushed with at most SIDEWAYS times the press, and a little more as the hand is stopped."""
    found = strokes_of(shape(lambda x, y: np.where(np.abs(x % 0.02 - 0.01) < 0.005, 0.005, 0.0)), press_n=3)
    assert found.held_up.any()
    assert found.force_n.max() < 3 * np.hypot(1, SIDEWAYS) * 1.15


def test_walls_hold_up_from_each_side_along_both_axes():
    for turn in range(4):
        heights = np.rot90(np.pad(np.full((64, 32), 0.01), ((0, 0), (32, 0))), turn)
        surface = shape(lambda x, y, heights=heights: np.kron(heights, np.ones((2, 2))))
        assert strokes_of(surface).held_up.mean() == pytest.approx(strokes_of(half_cliff()).held_up.mean(), rel=0.15)
        assert strokes_of(surface).held_up.any()


def half_cliff():
    return shape(lambda x, y: np.where(x > 0, 0.01, 0.0))


def test_hand_that_is_held_up_lifts_and_goes_on():
    cliff = shape(lambda x, y: np.where(x > -0.02, 0.005, 0.0))
    found = strokes_of(cliff).held_up.reshape(2 * LINES, -1)
    towards = found[:LINES:2]
    assert towards.any(axis=1).all() and not found[1:LINES:2].any()
    assert not towards[:, -50:].any()


def test_a_fall_of_the_force_is_no_rise():
    """A hand that slides off a cliff loses its press at once, and that takes no energy from anywhere."""
    teeth = shape(lambda x, y: 0.6 * (x % 0.003), 512)
    flight = fly(teeth, stiffness_n_per_m=400.0)
    assert np.mean(flight.strokes.rise_n < -flight.max_step_n) > 0.01
    assert of(cliffs(flight), "too sudden").verdict == "ok"
