"""Clocks of three systems in compiled code, two of them simulated: a wrong one makes every tick late or early."""

import ctypes
from typing import Any

import numpy as np
import pytest
from numba.experimental import function_type as function_type  # which teaches numba the functions of a clock

from tangible_core.runtime.system.timers import Timer, now_ns
from tangible_core.servo.ticks import clock


def address(function: Any) -> int:
    return ctypes.cast(function, ctypes.c_void_p).value or 0


class Simulated:
    """A system whose time passes only while somebody sleeps, and by one step a look at the clock."""

    def __init__(self, number: int, base: int) -> None:
        self.number, self.base, self.steps, self.sleeps, self.due = number, base, 10**13, 0, 0
        self.kept: list[Any] = []

    def time_ns(self) -> int:
        return self.steps * self.number // self.base

    def add(self, result: Any, *arguments: Any) -> Any:
        def keep(function: Any) -> int:
            self.kept.append(ctypes.CFUNCTYPE(result, *arguments)(function))
            return address(self.kept[-1])

        return keep

    def look(self) -> int:
        self.steps += 1
        return self.steps


def windows(frequency: int) -> tuple[Simulated, Timer]:
    system = Simulated(10**9, frequency)
    pointer, int64 = ctypes.c_size_t, ctypes.POINTER(ctypes.c_int64)

    def counter(result: Any) -> int:
        result[0] = system.look()
        return 1

    def start(handle: int, due: Any, *_: int) -> int:
        assert (handle, due[0] < 0) == (77, True)
        system.due = -due[0]
        return 1

    def wait(handle: int, most_ms: int) -> int:
        system.sleeps += 1
        system.steps += -(-min(system.due * 100, most_ms * 10**6) * frequency // 10**9)
        return 0

    return system, Timer(
        (10**9, frequency, 77),
        system.add(ctypes.c_int32, int64)(counter),
        system.add(ctypes.c_int32, pointer, int64, ctypes.c_int32, pointer, pointer, ctypes.c_int32)(start),
        system.add(ctypes.c_uint32, pointer, ctypes.c_uint32)(wait),
    )


def mach(number: int, base: int) -> tuple[Simulated, Timer]:
    system = Simulated(number, base)

    def until(steps: int) -> int:
        system.sleeps += 1
        system.steps = max(system.steps, steps)
        return 0

    return system, Timer(
        (number, base, 0), system.add(ctypes.c_uint64)(system.look), system.add(ctypes.c_int32, ctypes.c_uint64)(until)
    )


def test_compiled_clock_is_the_programs():
    here = clock.clock()
    before = now_ns()
    assert before <= clock.now_ns(here) <= now_ns()
    due = now_ns() + 2_000_000
    assert clock.wait_ns(here, due, 100_000) >= due


@pytest.mark.parametrize(("kind", "after_ns"), [("windows", 2_500_000_000), ("mach", 1_000_000)])
def test_compiled_sleep_ends_when_the_tick_is_due(kind: str, after_ns: int):
    system, timer = windows(10**7) if kind == "windows" else mach(125, 3)
    words = clock.clock(kind, timer)
    now, wait = (getattr(clock, f"{kind}_{name}") for name in ("now_ns", "wait_ns"))
    at_ns = now(words)
    assert at_ns == system.time_ns()
    due = at_ns + after_ns
    lead_ns = 50_000
    reached = wait(words, due, lead_ns)
    assert due <= reached <= due + 1_000
    assert 1 <= system.sleeps <= 4
    assert np.int64(reached) == reached
