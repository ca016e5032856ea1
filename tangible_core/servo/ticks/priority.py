"""Requests to the operating system for a loop that wakes on time."""

import ctypes
import os
import platform
import struct
import sys
from collections.abc import Callable
from typing import Any

PRIORITY = 50
"""Priority of SCHED_FIFO, 1 to 99: above everything that is not real time, below the kernel's own threads."""
CURRENT_AND_FUTURE, SET_TIMER_SLACK = 3, 29
"""MCL_CURRENT | MCL_FUTURE of mlockall, and PR_SET_TIMERSLACK of prctl; Linux."""
SLICE_NS = 100_000
"""The shortest time slice that may be requested (Linux 6.12): threads with shorter slices are scheduled sooner."""
SET_ATTRIBUTES = {"x86_64": 314, "aarch64": 274, "riscv64": 274}
"""Number of the system call sched_setattr in a 64-bit process, by machine; most C libraries have no function for it."""


def request() -> tuple[bool, str]:
    """Request real time for the calling thread; return whether it was granted, and a sentence about it."""
    if sys.platform != "linux":
        return False, f"plain sleeping: no real-time rights are requested on {sys.platform}"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except OSError as error:
        _c("prctl")(SET_TIMER_SLACK, 1, 0, 0, 0)
        shorten_slice()
        refused = f"SCHED_FIFO is not permitted ({error.strerror})"
        return False, f"plain sleeping: {refused}, so busy programs make ticks late; give the user an rtprio limit"
    memory = "memory locked" if _c("mlockall")(CURRENT_AND_FUTURE) == 0 else "memory not locked"
    return True, f"SCHED_FIFO {PRIORITY}, {memory}"


def shorten_slice() -> None:
    """Request the shortest time slice for the calling thread, which needs no rights; the niceness stays.

    Older kernels ignore the request. A thread in another class, such as SCHED_IDLE, stays as it is, as its user chose.
    """
    call = SET_ATTRIBUTES.get(platform.machine())
    if call is None or sys.maxsize < 2**32 or os.sched_getscheduler(0) != os.SCHED_OTHER:
        return
    niceness = os.getpriority(os.PRIO_PROCESS, 0)
    fields = 0, niceness, 0, SLICE_NS, 0, 0  # flags, niceness, priority, runtime, deadline, period
    attributes = struct.pack("=IIQiIQQQ", struct.calcsize("=IIQiIQQQ"), os.SCHED_OTHER, *fields)
    _c("syscall")(call, 0, attributes, 0)


def _c(name: str) -> Callable[..., Any]:
    return getattr(ctypes.CDLL(None), name)
