"""The monotonic clock, and sleeping until a time on it, for compiled code. Imports numba.

Only on Linux can a function that Python can reach sleep until a time without Python's lock; elsewhere a loop calls
Python to sleep.
"""

# ruff: noqa: ANN001, ANN201 -- the types are those that numba infers
# pyright: basic

import ctypes
import sys
from typing import Any, final

import numpy as np
from numba import int32, types, uintp

from ...compiled.compiling import KERNEL, njit

MONOTONIC, ABSOLUTE = 1, 1
"""CLOCK_MONOTONIC and TIMER_ABSTIME of Linux."""
SLEEPS = sys.platform == "linux"
"""True if compiled code can sleep on this system."""
SECOND_NS = 1_000_000_000


@final
class _ForeignFunction(types.WrapperAddressProtocol):
    """A function of the C library."""

    def __init__(self, name: str, signature: Any) -> None:
        self._address = ctypes.cast(getattr(ctypes.CDLL(None), name), ctypes.c_void_p).value
        self._signature = signature

    def signature(self) -> Any:
        return self._signature

    def __wrapper_address__(self) -> Any:
        return self._address


def clock() -> tuple[np.ndarray, Any, Any]:
    """Return the clock for `now_ns` and `wait_ns`: two words, and two functions of the C library for them."""
    read = _ForeignFunction("clock_gettime", int32(int32, uintp))
    sleep = _ForeignFunction("clock_nanosleep", int32(int32, int32, uintp, uintp))
    return np.zeros(2, np.int64), read, sleep


@njit(**KERNEL)
def now_ns(clock):
    """Return the time of the monotonic clock, nanoseconds."""
    words, read, _ = clock
    read(int32(MONOTONIC), words.ctypes.data)
    return words[0] * SECOND_NS + words[1]


@njit(**KERNEL)
def wait_ns(clock, deadline_ns, lead_ns):
    """Sleep until lead_ns before the deadline, then spin; return the time of the clock, nanoseconds.

    If a signal ends the sleep early, the rest is slept.
    """
    words, _, sleep = clock
    wake_ns = deadline_ns - lead_ns
    at_ns = now_ns(clock)
    while at_ns < wake_ns:
        words[0], words[1] = wake_ns // SECOND_NS, wake_ns % SECOND_NS
        sleep(int32(MONOTONIC), int32(ABSOLUTE), words.ctypes.data, uintp(0))
        at_ns = now_ns(clock)
    while at_ns < deadline_ns:
        at_ns = now_ns(clock)
    return at_ns
