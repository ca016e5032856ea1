"""What the operating system can be asked for so that a loop is woken on time."""

import ctypes
import os
import sys
from collections.abc import Callable
from typing import Any

PRIORITY = 50
"""Of SCHED_FIFO, 1 to 99: over everything that is not real time, under the kernel's own threads."""
CURRENT_AND_FUTURE, SET_TIMER_SLACK = 3, 29
"""MCL_CURRENT | MCL_FUTURE of mlockall, and PR_SET_TIMERSLACK of prctl; Linux."""


def ask() -> tuple[bool, str]:
    """Ask for all that there is for the calling thread; whether it is real time now, and what was granted, in words."""
    if sys.platform != "linux":
        return False, f"plain sleeping: {sys.platform} is asked for nothing"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except OSError as error:
        _c("prctl")(SET_TIMER_SLACK, 1, 0, 0, 0)
        return False, f"plain sleeping: SCHED_FIFO is not permitted ({error.strerror}); give the user an rtprio limit"
    kept = "memory locked" if _c("mlockall")(CURRENT_AND_FUTURE) == 0 else "memory not locked"
    return True, f"SCHED_FIFO {PRIORITY}, {kept}"


def _c(name: str) -> Callable[..., Any]:
    return getattr(ctypes.CDLL(None), name)
