"""Requests to the operating system for a loop, with simulated answers: without them ticks come late."""

import platform
import struct
from types import SimpleNamespace

import pytest

from tangible_core.runtime.system import priority

ON_LINUX = "x86_64", 314


class FakeCalls:
    """Fakes of the C library's functions, with the arguments of each call."""

    def __init__(self) -> None:
        self.calls: list[tuple] = []

    def __call__(self, name: str):
        return lambda *arguments: self.calls.append((name, *arguments)) or 0


@pytest.fixture
def linux(monkeypatch: pytest.MonkeyPatch) -> FakeCalls:
    """Linux on a 64-bit processor, with a thread of niceness 3 to which real time is refused."""
    fakes = FakeCalls()

    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    system = SimpleNamespace(
        SCHED_FIFO=1,
        SCHED_OTHER=0,
        PRIO_PROCESS=0,
        sched_param=lambda number: number,
        sched_setscheduler=refuse,
        sched_getscheduler=lambda _: 0,
        getpriority=lambda *_: 3,
    )
    monkeypatch.setattr(priority, "os", system)
    monkeypatch.setattr(priority, "_c", fakes)
    monkeypatch.setattr(priority.sys, "platform", "linux")
    monkeypatch.setattr(platform, "machine", lambda: ON_LINUX[0])
    return fakes


def test_request_without_rights_sets_shortest_slack_and_slice_and_keeps_niceness(linux: FakeCalls):
    real_time, said = priority.request()
    assert not real_time
    assert said == (
        "plain sleeping: SCHED_FIFO is not permitted (Operation not permitted), so busy programs make ticks late; "
        "give the user an rtprio limit"
    )
    slack, (name, number, thread, attributes, flags) = linux.calls
    assert slack == ("prctl", priority.SET_TIMER_SLACK, 1, 0, 0, 0)
    assert (name, number, thread, flags) == ("syscall", ON_LINUX[1], 0, 0)
    assert struct.unpack("=IIQiIQQQ", attributes) == (48, 0, 0, 3, 0, 100_000, 0, 0)


@pytest.mark.parametrize("policy", [3, 5, 0x40000000])
def test_thread_of_another_class_stays_in_it(policy: int, linux: FakeCalls, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(priority.os, "sched_getscheduler", lambda _: policy)
    priority.shorten_slice()
    assert linux.calls == []
