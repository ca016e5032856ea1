"""Requests to the operating system for a thread that wakes on time."""

import ctypes
import os
import platform
import struct
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any

# Priority of SCHED_FIFO, 1 to 99: above everything that is not real time, below the kernel's own threads.
PRIORITY = 50
# MCL_CURRENT | MCL_FUTURE of mlockall, and PR_SET_TIMERSLACK of prctl; Linux.
CURRENT_AND_FUTURE, SET_TIMER_SLACK = 3, 29
# The shortest time slice that may be requested (Linux 6.12): threads with shorter slices are scheduled sooner.
SLICE_NS = 100_000
# Number of the system call sched_setattr in a 64-bit process, by machine; most C libraries have no function for it.
SET_ATTRIBUTES = {"x86_64": 314, "aarch64": 274, "riscv64": 274}
# HIGH_PRIORITY_CLASS, THREAD_PRIORITY_TIME_CRITICAL and THREAD_PRIORITY_NORMAL; Windows.
HIGH, TIME_CRITICAL, NORMAL = 0x80, 15, 0
CONSTRAINT_POLICY, STANDARD_POLICY = 2, 1  # THREAD_TIME_CONSTRAINT_POLICY and THREAD_STANDARD_POLICY of macOS
PERIOD_NS, WORK_NS, WITHIN_NS = 1_000_000, 300_000, 600_000
"""The promise to macOS: a period; work in each; and the time within which the work is done."""

if sys.platform == "win32":
    NAME = "real-time priority"
    """The name of real time on this system."""
    ADVICE = "plug a notebook in, and choose the power plan for best performance"
    """What a user can do to be granted real time, or to make more of it."""

    def request() -> tuple[bool, str]:
        """Request real time for the calling thread; return whether it was granted, and a sentence about it."""
        kernel: Any = ctypes.WinDLL("kernel32")
        kernel.GetCurrentProcess.restype = ctypes.c_void_p
        kernel.SetPriorityClass(ctypes.c_void_p(kernel.GetCurrentProcess()), HIGH)
        is_granted = _join_media() or _set_priority(TIME_CRITICAL)
        return is_granted, f"{NAME} granted" if is_granted else f"{NAME} refused"

    def _join_media() -> bool:
        """Ask the scheduler for multimedia, which raises this thread even above the priority that anybody can ask."""
        try:
            media: Any = ctypes.WinDLL("avrt")
            media.AvSetMmThreadCharacteristicsW.restype = ctypes.c_void_p
            return bool(media.AvSetMmThreadCharacteristicsW("Pro Audio", ctypes.byref(ctypes.c_uint32())))
        except (OSError, AttributeError):  # it is not installed, as on some servers
            return False

    def _set_priority(priority: int) -> bool:
        kernel: Any = ctypes.WinDLL("kernel32")
        kernel.GetCurrentThread.restype = ctypes.c_void_p
        return bool(kernel.SetThreadPriority(ctypes.c_void_p(kernel.GetCurrentThread()), priority))

    @contextmanager
    def real_time() -> Generator[bool]:
        """Run a block in real time if the system permits it; yield whether it does."""
        is_granted = _set_priority(TIME_CRITICAL)
        try:
            yield is_granted
        finally:
            _set_priority(NORMAL)

elif sys.platform == "darwin":
    NAME = "real-time priority"
    """The name of real time on this system."""
    ADVICE = "plug a notebook in, and switch its low-power mode off"
    """What a user can do to be granted real time, or to make more of it."""

    def request() -> tuple[bool, str]:
        """Request real time for the calling thread; return whether it was granted, and a sentence about it."""
        is_granted = _set_policy(CONSTRAINT_POLICY, *map(_mach_units, (PERIOD_NS, WORK_NS, WITHIN_NS)), 1)
        return is_granted, f"{NAME} granted" if is_granted else f"{NAME} refused"

    def _set_policy(policy: int, *words: int) -> bool:
        system = ctypes.CDLL(None)
        system.mach_thread_self.restype = ctypes.c_uint32
        values = (ctypes.c_uint32 * max(1, len(words)))(*words)
        return system.thread_policy_set(system.mach_thread_self(), policy, values, len(words)) == 0

    def _mach_units(time_ns: int) -> int:
        base = (ctypes.c_uint32 * 2)()
        ctypes.CDLL(None).mach_timebase_info(base)
        return time_ns * base[1] // base[0]

    @contextmanager
    def real_time() -> Generator[bool]:
        """Run a block in real time if the system permits it; yield whether it does."""
        is_granted, _ = request()
        try:
            yield is_granted
        finally:
            _set_policy(STANDARD_POLICY)

else:
    NAME = "SCHED_FIFO"
    """The name of real time on this system."""
    ADVICE = "permit real-time scheduling (`ulimit -r 99`, or `rtprio` in /etc/security/limits.conf)"
    """What a user can do to be granted real time, or to make more of it."""

    def request() -> tuple[bool, str]:
        """Request real time for the calling thread; return whether it was granted, and a sentence about it."""
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        except OSError as error:
            _c("prctl")(SET_TIMER_SLACK, 1, 0, 0, 0)
            shorten_slice()
            refusal = f"SCHED_FIFO is not permitted ({error.strerror})"
            return False, f"plain sleeping: {refusal}, so busy programs make ticks late; give the user an rtprio limit"
        memory = "memory locked" if _c("mlockall")(CURRENT_AND_FUTURE) == 0 else "memory not locked"
        return True, f"SCHED_FIFO {PRIORITY}, {memory}"

    def shorten_slice() -> None:
        """Request the shortest time slice for the calling thread, which needs no rights; the niceness stays.

        Older kernels ignore the request. A thread in another class, such as SCHED_IDLE, stays as it is, as its user
        chose.
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

    @contextmanager
    def real_time() -> Generator[bool]:
        """Run a block in real time if the system permits it; yield whether it does."""
        try:
            before = os.sched_getscheduler(0), os.sched_getparam(0)
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        except OSError:  # not permitted
            yield False
            return
        try:
            yield True
        finally:
            os.sched_setscheduler(0, *before)
