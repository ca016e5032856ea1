"""Replay of recorded states: a law is judged by forces that it would not give."""

import numpy as np
import pytest

from tangible_core.data import Force, HapticState, HapticSurface, TickFlag
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.servo import Safety
from tangible_core.session import Recording, replay, run_simulated, unaltered_forces
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


def test_replay_with_the_same_law_is_identical(stroke: Recording):
    """Friction and damping too: the velocities are those that were recorded, not steps between positions."""
    again = replay(LAW.touch(SURFACE), stroke)
    assert np.array_equal(again.rows[:, :14], stroke.rows[:, :14], equal_nan=True)
    assert np.array_equal(again.flags[1:], stroke.flags[1:])  # force faded in at the first tick, from none


def test_replay_with_another_law_changes_force_proxy_and_flags(stroke: Recording):
    again = replay(Penalty(stiffness_n_per_m=300).touch(SURFACE), stroke)
    assert np.array_equal(again.rows[:, :8], stroke.rows[:, :8])
    assert np.isnan(again.proxy_m).all()
    touch = Penalty(stiffness_n_per_m=300).touch(SURFACE)
    assert np.array_equal(again.force_n, [touch.force(HapticState(tuple(at))) for at in stroke.position_m.tolist()])
    assert np.array_equal(again.flags == TickFlag.TOUCHING, again.force_n.any(axis=1))


def test_replay_of_python_law_has_velocities_and_buttons():
    rows = np.random.default_rng(0).normal(size=(8, 17))
    rows[:, 14:16] = np.arange(16).reshape(8, 2)
    again = replay(Viscous(), Recording(rows, "the cable is out"))
    held = (again.buttons & 2) > 0
    assert np.array_equal(again.force_n, -rows[:, 5:8] * held[:, None])
    assert np.array_equal(again.flags, TickFlag.TOUCHING * held)  # not what was recorded
    assert np.isnan(again.proxy_m).all()
    assert again.stopped == "the cable is out"


def test_replay_of_empty_recording_is_empty():
    assert replay(LAW.touch(SURFACE), Recording(np.empty((0, 17)))).rows.shape == (0, 17)
    assert replay(Viscous(), Recording(np.empty((0, 17)))).rows.shape == (0, 17)


@pytest.mark.parametrize("flag", list(TickFlag))
def test_unaltered_forces_are_those_of_the_law_alone(flag: TickFlag):
    rows = np.ones((2, 17))
    rows[:, 14], rows[:, 16] = (0, flag), np.nan
    own = np.isfinite(unaltered_forces(Recording(rows))).all(axis=1)
    assert own.tolist() == [True, flag in (TickFlag.TOUCHING, TickFlag.OVERRUN, TickFlag.SWAPPED)]
