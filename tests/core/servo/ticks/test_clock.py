"""Clocks of three systems and the schedule of ticks: ticks that are made up for push a hand twice."""

import ctypes
from typing import Any

import numpy as np
import pytest
from numba.experimental import function_type as function_type  # which teaches numba the functions of a clock

from tangible_core.runtime.system.timers import Timer, now_ns
from tangible_core.servo.ring import LEAD_NS, NEXT_NS, OVERRUNS, PERIOD_NS, SPINS
from tangible_core.servo.ticks import clock, cycle, schedule


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


PERIOD, FIRST = 1_000_000, 5_000_000
COMPILED = pytest.mark.parametrize("begin_tick", [schedule.begin_tick, cycle.begin_tick], ids=["python", "compiled"])


def header(lead_ns: int = 0, spins: bool = False) -> np.ndarray:
    """Return the header of a loop whose first tick is due."""
    words = np.zeros(64, np.int64)
    words[[PERIOD_NS, NEXT_NS, LEAD_NS, SPINS]] = PERIOD, FIRST, lead_ns, spins
    return words


@COMPILED
@pytest.mark.parametrize(
    ("late_ns", "missed"), [(0, 0), (999_999, 0), (1_000_000, 1), (3_500_000, 3), (1_000_000_000, 1000)]
)
def test_missed_periods_are_counted_and_the_next_tick_is_in_step(begin_tick, late_ns: int, missed: int):
    words = header()
    assert begin_tick(words, FIRST + late_ns) == late_ns
    assert words[OVERRUNS] == missed
    assert words[NEXT_NS] == FIRST + (missed + 1) * PERIOD
    assert words[NEXT_NS] > FIRST + late_ns, "nothing is made up for"
    begin_tick(words, words[NEXT_NS] + 2 * PERIOD)
    assert words[OVERRUNS] == missed + 2


@COMPILED
@pytest.mark.parametrize(
    ("late_ns", "before_ns", "after_ns"),
    [
        (1_001, 20_000, 30_000),
        (1_001, 145_000, 150_000),
        (10_000_000, 150_000, 150_000),
        (1_000, 20_000, 19_990),
        (0, 10, 0),
        (0, 5, 0),
        (0, 0, 0),
    ],
)
def test_lead_grows_fast_and_shrinks_by_a_thousandth_of_that(begin_tick, late_ns: int, before_ns: int, after_ns: int):
    words = header(before_ns, spins=True)
    begin_tick(words, FIRST + late_ns)
    assert words[LEAD_NS] == after_ns


@COMPILED
@pytest.mark.parametrize("late_ns", [0, 50_000])
def test_lead_without_the_right_to_spin_is_zero(begin_tick, late_ns: int):
    words = header()
    begin_tick(words, FIRST + late_ns)
    assert words[LEAD_NS] == 0
