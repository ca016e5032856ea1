"""Lateness of this machine. Otherwise late ticks would not be seen before a session."""

import os

import numpy as np
import pytest

from flights import level
from tangible_core import load_method
from tangible_core.preflight import timing


class Clock:
    """A clock that advances only in sleeps, always by a little too much, and once by far too much."""

    def __init__(self, over_s: float, stall_at: int, stall_s: float) -> None:
        self.now, self.sleeps = 100.0, 0
        self.over_s, self.stall_at, self.stall_s = over_s, stall_at, stall_s

    def perf_counter(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds + (self.stall_s if self.sleeps == self.stall_at else self.over_s)
        self.sleeps += 1


def test_measure_lateness_late_tick_counts_once(monkeypatch: pytest.MonkeyPatch):
    clock = Clock(over_s=1e-5, stall_at=4, stall_s=3.5e-3)
    monkeypatch.setattr(timing, "time", clock)
    late = timing.measure_lateness(0.02, 0.001)
    assert late.late_s.size == clock.sleeps == 20
    expected = np.full(20, 1e-5)
    expected[4] = 3.5e-3
    np.testing.assert_allclose(late.late_s, expected, atol=1e-9)
    assert late.overruns == 1 / 20
    assert late.at(100) == pytest.approx(3.5e-3)
    assert clock.now == pytest.approx(100 + 0.023 + 1e-5)


def test_measure_lateness_restores_the_scheduling(monkeypatch: pytest.MonkeyPatch):
    before = os.sched_getscheduler(0)
    late = timing.measure_lateness(0.05, 0.001)
    assert late.late_s.size == 50
    assert (late.late_s >= 0).all()
    assert os.sched_getscheduler(0) == before
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert not timing.measure_lateness(0.002, 0.001).real_time


def refuse(*_: object) -> None:
    raise PermissionError


def test_measure_ticks_times_every_tick():
    touch = load_method("render", "proxy")().touch(level())
    for ticks in (1, 50):
        cost = timing.measure_ticks(touch, np.tile([0.0, 0.0, 0.009], (ticks, 1)), 0.001)
        assert cost.call_s.size == ticks
        assert (cost.call_s > 0).all()
        assert cost.kernel_s > 0
        assert cost.at(50) <= cost.at(99) <= cost.at(100)
