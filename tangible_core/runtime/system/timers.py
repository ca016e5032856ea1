"""The clock of the force loop, and the functions of the system by which compiled code reads it and sleeps."""

import ctypes
import sys
import time
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

now_ns: Callable[[], int] = time.perf_counter_ns
"""The clock: nanoseconds from some start that all processes share."""
Kind = Literal["posix", "mach", "windows", ""]


class Timer(NamedTuple):
    """What compiled code needs to read the clock and to sleep: `servo.ticks.clock` calls these functions."""

    # For the kernels: two numbers by which the clock's steps become nanoseconds, and the handle of a timer.
    numbers: tuple[int, int, int]
    read: int  # address of the function that reads the clock
    sleep: int  # address of the function that sleeps
    wait: int = 0  # address of the function that waits for the timer; Windows


def _address(library: Any, name: str) -> int:
    return ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0


if sys.platform == "win32":
    KIND: Kind = "windows"
    """The kind of kernels for this system; empty where compiled code cannot sleep."""
    _HIGH_RESOLUTION, _ALL_ACCESS = 2, 0x1F0003
    """CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, from Windows 10 1803 on, and TIMER_ALL_ACCESS."""

    def timer() -> Timer:
        """Make the timer of a loop: QueryPerformanceCounter, and a waitable timer of high resolution."""
        kernel: Any = ctypes.WinDLL("kernel32")
        kernel.CreateWaitableTimerExW.restype = ctypes.c_void_p
        make = kernel.CreateWaitableTimerExW
        handle = make(None, None, _HIGH_RESOLUTION, _ALL_ACCESS)
        if not handle:  # an older Windows: a timer of the resolution that this process requests for all
            ctypes.WinDLL("winmm").timeBeginPeriod(1)
            handle = make(None, None, 0, _ALL_ACCESS)
        frequency = ctypes.c_int64()
        kernel.QueryPerformanceFrequency(ctypes.byref(frequency))
        names = "QueryPerformanceCounter", "SetWaitableTimer", "WaitForSingleObject"
        return Timer((1_000_000_000, frequency.value, handle), *(_address(kernel, name) for name in names))

elif sys.platform == "darwin":
    KIND: Kind = "mach"
    """The kind of kernels for this system; empty where compiled code cannot sleep."""

    def timer() -> Timer:
        """Make the timer of a loop: mach_absolute_time and mach_wait_until."""
        system = ctypes.CDLL(None)
        base = (ctypes.c_uint32 * 2)()
        system.mach_timebase_info(base)
        return Timer((base[0], base[1], 0), _address(system, "mach_absolute_time"), _address(system, "mach_wait_until"))

else:
    KIND: Kind = "posix" if sys.platform == "linux" else ""
    """The kind of kernels for this system; empty where compiled code cannot sleep."""

    def timer() -> Timer:
        """Make the timer of a loop: clock_gettime and clock_nanosleep."""
        system = ctypes.CDLL(None)
        return Timer((0, 0, 0), _address(system, "clock_gettime"), _address(system, "clock_nanosleep"))
