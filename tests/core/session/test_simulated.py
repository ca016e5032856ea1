"""Sessions in simulated time: their recordings, and that every end leaves no force."""

import logging
import math
from collections.abc import Callable
from threading import Event

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState, HapticSurface, ServoReport, TickFlag
from tangible_core.errors import ConfigError, DeviceError
from tangible_core.plugins.interfaces import HapticDevice, Link, PlainTouch
from tangible_core.servo import Safety
from tangible_core.servo.guard.safety import gain
from tangible_core.session import INTERRUPTED, failure, run_simulated, simulated
from tangible_core.session.recording import STOPPED
from tangible_devices.mock import Mock
from tangible_render.penalty_gradient import PenaltyGradient
from tangible_render.proxy import Proxy

PUSH = Force(0.0, 0.0, 2.0)
FREE = Safety(ramp_s=0, max_step_n=10, passivity="off")
"""Limits that pass every force but those that are too strong or not finite."""


class Says(PlainTouch):
    """A touch whose force is a function of the tick."""

    stiffness_n_per_m = 0.0

    def __init__(self, answer: Callable[[int], Force]) -> None:
        self.answer, self.tick = answer, -1

    def force(self, state: HapticState) -> Force:
        self.tick += 1
        return self.answer(self.tick)


class Scripted(Link):
    """A device that rises by a millimetre a tick, and fails or stands still at a given tick."""

    def __init__(self, fails_at: int | None = None, stamps: Callable[[int], float] = lambda tick: 5 + tick * 0.001):
        super().__init__("the scripted device", 8.0)
        self.fails_at, self.stamps = fails_at, stamps
        self.tick, self.held, self.closed, self.forces = -1, NO_FORCE, 0, []

    def _read(self) -> HapticState:
        self.tick += 1
        if self.fails_at is not None and self.tick >= self.fails_at:
            raise DeviceError("the cable is out; put it in")
        return HapticState((0.0, 0.0, self.tick * 0.001), (0.0, 0.0, 1.0), self.stamps(self.tick))

    def _send(self, force: Force) -> None:
        if self.fails_at is not None and self.tick >= self.fails_at:
            raise DeviceError("nobody answers")
        self.held = force
        self.forces.append(force)

    @property
    def applied(self) -> Force:
        return self.held

    def _release(self) -> None:
        self.closed += 1


LINKS: list[Link] = []


class Bench(HapticDevice):
    """A device that opens the link of the test."""

    def spec(self) -> DeviceSpec:
        return DeviceSpec(8.0, 3000.0, 20.0, (0.08, 0.08, 0.08), 1e-6)

    def open(self) -> Link:
        return LINKS.pop()


def feel(answer: Callable[[int], Force], seconds: float = 1.0, link: Scripted | None = None, **more):
    link = link or Scripted()
    LINKS[:] = [link]
    return run_simulated(Says(answer), Bench(), seconds, limits=FREE, **more), link


def fails(error: BaseException, at: int) -> Callable[[int], Force]:
    def answer(tick: int) -> Force:
        if tick == at:
            raise error
        return PUSH

    return answer


class TestRun:
    def test_recording_matches_the_forces_of_the_touch(self):
        touch = PenaltyGradient().touch(HapticSurface.from_heights(np.random.default_rng(0).uniform(0, 0.004, (9, 9))))
        mock = Mock(hand=None, path="circle", z_m=0.001)
        recording = run_simulated(touch, mock, 0.5, limits=FREE)
        with mock.open() as link:
            states = [link.read() for _ in range(500)]
        assert np.array_equal(recording.time_s, np.arange(500) * 0.001)
        assert np.array_equal(recording.position_m, [state.position_m for state in states])
        assert np.array_equal(recording.velocity_m_per_s, [state.velocity_m_per_s for state in states])
        assert np.array_equal(recording.force_n, touch.path(recording.position_m))
        assert (recording.stopped, recording.force_limited, recording.not_finite) == ("", 0, 0)

    @pytest.mark.parametrize(("seconds", "ticks"), [(0.3, 300), (0.0014, 1), (0.0016, 2), (1e-9, 1)])
    def test_number_of_ticks_is_the_time_in_periods(self, seconds: float, ticks: int):
        recording, link = feel(lambda _: PUSH, seconds)
        assert recording.time_s.size == ticks
        assert recording.time_s[0] == 5
        assert link.forces == [PUSH] * ticks + [NO_FORCE]
        assert link.closed == 1

    @given(st.integers(1, 400), st.sampled_from([1e-4, 3e-4, 1e-3, 2e-3, 7e-3, 0.1]), st.floats(-100, 100))
    def test_number_of_ticks_survives_rounding_of_stamps(self, ticks: int, period: float, start: float):
        link = Scripted(stamps=lambda tick: start + tick * period)
        recording, _ = feel(lambda _: PUSH, ticks * period, link)
        assert recording.time_s.size == ticks

    def test_frames_and_reports_are_told_the_time(self):
        reports: list[ServoReport] = []
        recording, _ = feel(lambda _: PUSH, 1.0, on_report=reports.append)
        assert [report.time_s for report in reports[:-1]] == pytest.approx(5 + np.arange(1, 10) * 0.1, abs=0.0011)
        assert [report.stopped for report in reports] == [""] * 9 + ["the time is over"]
        last = reports[-1]
        assert (last.ticks, last.peak_force_n, last.force) == (1000, 2.0, PUSH)
        assert last.state.position_m == pytest.approx((0, 0, 0.999))
        assert last.work_j == pytest.approx(2.0 * 0.999)
        assert recording.work_j == pytest.approx(last.work_j, rel=1e-12)
        told: list[float] = []
        feel(lambda _: PUSH, 0.004, frames=told.append)
        assert told == pytest.approx([0.0, 0.001, 0.002, 0.003])
        reports: list[ServoReport] = []
        recording, _ = feel(lambda tick: Force(0.0, 0.0, tick + 1.0), 0.004, on_report=reports.append)
        assert recording.work_j == pytest.approx((1 + 2 + 3) * 0.001)

    @pytest.mark.parametrize("bad", [math.nan, -math.inf])
    def test_forces_not_finite_are_set_to_zero_and_counted(self, bad: float, caplog: pytest.LogCaptureFixture):
        recording, link = feel(lambda tick: Force(0.0, bad, 1.0) if tick in (3, 4) else PUSH, 0.01)
        assert (recording.not_finite, recording.force_limited) == (2, 0)
        assert link.forces[2:6] == [PUSH, NO_FORCE, NO_FORCE, PUSH]
        assert "2 forces were not finite" in caplog.text

    def test_applied_force_is_recorded_and_scaled_to_the_device(self):
        class Weak(Scripted):
            @property
            def applied(self) -> Force:
                return Force(*(part / 2 for part in self.held))

        recording, _ = feel(lambda _: PUSH, 0.01, Weak())
        assert recording.force_n.tolist() == [[0.0, 0.0, 1.0]] * 10
        level = HapticSurface.from_heights(np.zeros((8, 8)))
        device = Mock(hand=None, path="circle", z_m=-0.001)
        held = gain(FREE.arrays(device.spec(), 4000.0)[0], 0.001)
        recording = run_simulated(Proxy(stiffness_n_per_m=4000).touch(level), device, 0.01, limits=FREE)
        assert held < 1
        assert (recording.flags & TickFlag.STIFFNESS_LIMITED).all()
        assert recording.force_n[:, 2] == pytest.approx(held * 4000 * 0.001)

    @pytest.mark.parametrize("seconds", [0.0, math.nan, math.inf])
    def test_seconds_that_are_invalid_are_refused(self, seconds: float):
        with pytest.raises(ConfigError, match="seconds"):
            feel(lambda _: PUSH, seconds)


class TestRows:
    def test_recording_has_proxy_flags_and_buttons(self):
        surface = HapticSurface.from_heights(np.full((8, 8), 1 / 128))
        recording = run_simulated(
            Proxy().touch(surface), Mock(hand=None, path="press", z_m=1 / 128 - 0.02, lift_m=0.03), 0.6
        )
        touching = recording.force_n[:, 2] > 0
        assert 0 < np.mean(touching) < 1
        assert np.array_equal(touching, np.isfinite(recording.proxy_m).all(axis=1))
        assert np.array_equal(touching, (recording.flags & TickFlag.TOUCHING) > 0)
        assert np.allclose(recording.proxy_m[touching, 2], 1 / 128)
        deep = 800 * (1 / 128 - recording.position_m[:, 2]) > 8
        assert deep.any()
        assert np.array_equal(deep, (recording.flags & TickFlag.FORCE_LIMITED) > 0)


class TestEndings:
    def test_stop_or_ctrl_c_ends_the_session_without_force(self, caplog: pytest.LogCaptureFixture):
        caplog.set_level(logging.INFO)
        reports: list[ServoReport] = []
        recording, link = feel(fails(KeyboardInterrupt(), 50), on_report=reports.append)
        assert recording.stopped == INTERRUPTED == reports[-1].stopped
        assert recording.time_s.size == 50
        assert (link.held, link.closed) == (NO_FORCE, 1)
        assert [record.levelname for record in caplog.records] == ["INFO"]
        stop = Event()
        recording, link = feel(lambda tick: PUSH if tick != 20 else stop.set() or PUSH, stop=stop)
        assert (recording.stopped, recording.time_s.size) == (STOPPED, 21)
        assert (link.held, link.closed) == (NO_FORCE, 1)

    @pytest.mark.parametrize("ticks", [20, 0])
    def test_device_that_stops_answering_ends_the_session(self, ticks: int):
        recording, link = feel(lambda _: PUSH, link=Scripted(fails_at=ticks))
        assert recording.stopped == "the cable is out; put it in"
        assert recording.time_s.size == ticks
        assert link.closed == 1
        assert f"after {ticks} ticks: the cable is out; put it in" in str(failure(ticks, recording.stopped))

    @pytest.mark.parametrize("stamps", [lambda _: 1.0, lambda tick: math.nan if tick else 0.0])
    def test_clock_that_stands_still_ends_the_session(self, stamps):
        recording, link = feel(lambda _: PUSH, link=Scripted(stamps=stamps))
        assert "clock stands still" in recording.stopped
        assert recording.time_s.size == 1
        assert link.held == NO_FORCE

    def test_full_recording_or_failing_touch_ends_the_session(self, monkeypatch: pytest.MonkeyPatch):
        link = Scripted()
        with pytest.raises(ZeroDivisionError):
            feel(fails(ZeroDivisionError(), 5), link=link)
        assert (link.held, link.closed) == (NO_FORCE, 1)
        monkeypatch.setattr(simulated, "MAX_TICKS", 30)
        recording, link = feel(lambda _: PUSH, 1e9)
        assert "full, 30 ticks" in recording.stopped
        assert recording.time_s.size == 30
        assert link.held == NO_FORCE
