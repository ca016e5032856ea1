"""The clock of `runtime.system.timers`, and sleeping until a time on it, for compiled code. Imports numba."""

# pyright: basic

from typing import Any, final

import numpy as np
from numba import int32, int64, types, uint32, uint64, uintp

from ...compiled.compiling import KERNEL, njit
from ...runtime.system import timers

MONOTONIC, ABSOLUTE = 1, 1  # CLOCK_MONOTONIC and TIMER_ABSTIME of Linux
SLEEPS = timers.KIND != ""  # true if compiled code can sleep on this system
SECOND_NS = 1_000_000_000
NUMBER, BASE, TIMER = 2, 3, 4
"""Words of a clock, after two for what a function writes: steps become nanoseconds by NUMBER / BASE; a timer's handle.
"""
# The longest single wait for a timer of Windows, ms; a loop with a longer period waits again.
LONGEST_MS = 1000


@final
class _ForeignFunction(types.WrapperAddressProtocol):
    """A function of the system's library."""

    def __init__(self, address: int, signature: Any) -> None:
        self._address, self._signature = address, signature

    def signature(self) -> Any:
        return self._signature

    def __wrapper_address__(self) -> Any:
        return self._address


SIGNATURES: dict[str, Any] = {
    "posix": (int32(int32, uintp), int32(int32, int32, uintp, uintp)),
    "mach": (uint64(), int32(uint64)),
    "windows": (int32(uintp), int32(uintp, uintp, int32, uintp, uintp, int32), uint32(uintp, uint32)),
}
"""Signatures of the functions of a `Timer` that kernels call, in their order, by kind."""


def clock(kind: str = timers.KIND, timer: "timers.Timer | None" = None) -> tuple[Any, ...]:
    """Return the clock for `now_ns` and `wait_ns`: five words, and the functions of the system for them."""
    numbers, *addresses = timer or timers.timer()
    words = np.array([0, 0, *numbers], np.int64)
    return words, *map(_ForeignFunction, addresses[: len(SIGNATURES[kind])], SIGNATURES[kind])


@njit(**KERNEL)
def posix_now_ns(clock):
    """Return the time of the clock, nanoseconds: a second and a rest."""
    words, read, _ = clock
    read(int32(MONOTONIC), words.ctypes.data)
    return words[0] * SECOND_NS + words[1]


@njit(**KERNEL)
def posix_wait_ns(clock, deadline_ns, lead_ns):
    """Sleep until lead_ns before the deadline, then spin; return the time of the clock, nanoseconds."""
    words, _, sleep = clock
    wake_ns = deadline_ns - lead_ns
    at_ns = posix_now_ns(clock)
    # A loop, as a signal may end the sleep early: then the rest is slept.
    while at_ns < wake_ns:
        words[0], words[1] = wake_ns // SECOND_NS, wake_ns % SECOND_NS
        sleep(int32(MONOTONIC), int32(ABSOLUTE), words.ctypes.data, uintp(0))
        at_ns = posix_now_ns(clock)
    while at_ns < deadline_ns:
        at_ns = posix_now_ns(clock)
    return at_ns


@njit(**KERNEL)
def mach_now_ns(clock):
    """Return the time of the clock, nanoseconds, as `time.perf_counter_ns` rounds it."""
    words, read, _ = clock
    steps = int64(read())
    return steps // words[BASE] * words[NUMBER] + steps % words[BASE] * words[NUMBER] // words[BASE]


@njit(**KERNEL)
def mach_wait_ns(clock, deadline_ns, lead_ns):
    """Sleep until lead_ns before the deadline, then spin; return the time of the clock, nanoseconds."""
    words, _, sleep = clock
    wake_ns = deadline_ns - lead_ns
    at_ns = mach_now_ns(clock)
    while at_ns < wake_ns:
        number, base = words[NUMBER], words[BASE]
        sleep(uint64(wake_ns // number * base + (wake_ns % number * base + number - 1) // number))
        at_ns = mach_now_ns(clock)
    while at_ns < deadline_ns:
        at_ns = mach_now_ns(clock)
    return at_ns


@njit(**KERNEL)
def windows_now_ns(clock):
    """Return the time of the clock, nanoseconds, as `time.perf_counter_ns` rounds it."""
    words, read = clock[0], clock[1]
    read(words.ctypes.data)
    steps = words[0]
    return steps // words[BASE] * words[NUMBER] + steps % words[BASE] * words[NUMBER] // words[BASE]


@njit(**KERNEL)
def windows_wait_ns(clock, deadline_ns, lead_ns):
    """Sleep until lead_ns before the deadline, then spin; return the time of the clock, nanoseconds."""
    words, _, start, wait = clock
    wake_ns = deadline_ns - lead_ns
    at_ns = windows_now_ns(clock)
    while at_ns < wake_ns:
        # The timer takes steps of 100 ns; a negative number of them is a time from now.
        words[1] = -((wake_ns - at_ns + 99) // 100)
        timer = uintp(words[TIMER])
        start(timer, words[1:].ctypes.data, int32(0), uintp(0), uintp(0), int32(0))
        wait(timer, uint32(LONGEST_MS))
        at_ns = windows_now_ns(clock)
    while at_ns < deadline_ns:
        at_ns = windows_now_ns(clock)
    return at_ns


now_ns: Any
wait_ns: Any
now_ns, wait_ns = {
    "posix": (posix_now_ns, posix_wait_ns),
    "mach": (mach_now_ns, mach_wait_ns),
    "windows": (windows_now_ns, windows_wait_ns),
    "": (None, posix_wait_ns),
}[timers.KIND]
"""The kernels of this system."""
