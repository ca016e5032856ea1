"""Replay and comparison of recordings: a law is judged by forces that it would not give."""

import math

import numpy as np
import pytest

from tangible_core.data import Force, HapticState, HapticSurface, TickFlag
from tangible_core.errors import ConfigError
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.servo import Safety
from tangible_core.session import Recording, compare_recordings, replay, run_simulated, unaltered_forces
from tangible_core.session.recording.replay import MAX_COMPARED
from tangible_devices.mock import Mock
from tangible_render.penalty import Penalty
from tangible_render.proxy import Proxy

SURFACE = HapticSurface.from_heights(np.random.default_rng(0).uniform(0.004, 0.006, (16, 16)))
LAW = Proxy(damping_n_s_per_m=3.0, static_friction=0.5, dynamic_friction=0.3)


class Viscous(PlainTouch):
    """A law in Python: against the velocity, while a button is held."""

    def force(self, state: HapticState) -> Force:
        vx, vy, vz = state.velocity_m_per_s
        return Force(-vx, -vy, -vz) if state.buttons & 2 else Force(0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def stroke() -> Recording:
    free = Safety(ramp_s=0, max_step_n=10, passivity="off")
    return run_simulated(LAW.touch(SURFACE), Mock(speed_m_per_s=0.2, tremor_m=1e-4), 1.0, limits=free)


def test_replay_is_identical_with_the_same_law_alone(stroke: Recording):
    """Friction and damping too: the velocities are those that were recorded, not steps between positions."""
    again = replay(LAW.touch(SURFACE), stroke)
    assert np.array_equal(again.rows[:, :14], stroke.rows[:, :14], equal_nan=True)
    assert np.array_equal(again.flags[1:], stroke.flags[1:])  # force faded in at the first tick, from none
    again = replay(Penalty(stiffness_n_per_m=300).touch(SURFACE), stroke)
    assert np.array_equal(again.rows[:, :8], stroke.rows[:, :8])
    assert np.isnan(again.proxy_m).all()
    touch = Penalty(stiffness_n_per_m=300).touch(SURFACE)
    assert np.array_equal(again.force_n, [touch.force(HapticState(tuple(at))) for at in stroke.position_m.tolist()])
    assert np.array_equal(again.flags == TickFlag.TOUCHING, again.force_n.any(axis=1))


def test_replay_has_velocities_and_buttons_and_may_be_empty():
    rows = np.random.default_rng(0).normal(size=(8, 17))
    rows[:, 14:16] = np.arange(16).reshape(8, 2)
    again = replay(Viscous(), Recording(rows, "the cable is out"))
    held = (again.buttons & 2) > 0
    assert np.array_equal(again.force_n, -rows[:, 5:8] * held[:, None])
    assert np.array_equal(again.flags, TickFlag.TOUCHING * held)  # not what was recorded
    assert np.isnan(again.proxy_m).all()
    assert again.stopped == "the cable is out"
    assert replay(LAW.touch(SURFACE), Recording(np.empty((0, 17)))).rows.shape == (0, 17)
    assert replay(Viscous(), Recording(np.empty((0, 17)))).rows.shape == (0, 17)


@pytest.mark.parametrize("flag", list(TickFlag))
def test_unaltered_forces_are_those_of_the_law_alone(flag: TickFlag):
    rows = np.ones((2, 17))
    rows[:, 14], rows[:, 16] = (0, flag), np.nan
    own = np.isfinite(unaltered_forces(Recording(rows))).all(axis=1)
    assert own.tolist() == [True, flag in (TickFlag.TOUCHING, TickFlag.OVERRUN, TickFlag.SWAPPED)]


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


def test_comparison_is_exact_at_different_speeds_and_works_without_ticks():
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
    found = compare_recordings(press(0, 0.3), press(0, 0.3, ticks=1501))
    assert found["error_n"] == pytest.approx(0, abs=0.05)
    assert found["first_work_j"] == pytest.approx(-0.3 * 2 * WIDE_M, rel=0.01)
    assert compare_recordings(press(0, 0.3), press(0, 0.1))["error_n"] == pytest.approx(0.2, rel=0.02)
    empty, one = Recording(np.empty((0, 17))), press(1000)
    assert compare_recordings(empty, one)["compared"] == compare_recordings(one, empty)["compared"] == 0
    lost = one.rows.copy()
    lost[:1000, 2] = np.nan
    assert compare_recordings(Recording(lost), one)["compared"] == 1001
    assert compare_recordings(one, Recording(lost))["compared"] > 1000
    assert compare_recordings(press(1000, ticks=2 * MAX_COMPARED), one)["compared"] == MAX_COMPARED
    with pytest.raises(ConfigError, match="near_m: is 0; it must be positive"):
        compare_recordings(one, one, 0)
