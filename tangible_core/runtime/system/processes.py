"""Processes: is one alive, end with the parent, start one that receives no Ctrl-C, give way to others; memory."""

import os
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

if sys.platform == "win32":
    import ctypes
    from ctypes import wintypes

    _SYNCHRONIZE, _QUERY = 0x00100000, 0x1000
    """SYNCHRONIZE and PROCESS_QUERY_LIMITED_INFORMATION of OpenProcess."""
    _DENIED, _RUNS, _FOREVER = 5, 0x102, 0xFFFFFFFF
    """ERROR_ACCESS_DENIED, WAIT_TIMEOUT and INFINITE."""

    def _kernel() -> Any:
        kernel = ctypes.WinDLL("kernel32", use_last_error=True)
        kernel.OpenProcess.restype = wintypes.HANDLE
        kernel.WaitForSingleObject.argtypes = wintypes.HANDLE, wintypes.DWORD
        kernel.CloseHandle.argtypes = (wintypes.HANDLE,)
        return kernel

    def is_alive(process: int) -> bool:
        """Return True if a process of this number runs, of any user. (`os.kill` would end it.)"""
        kernel = _kernel()
        handle = kernel.OpenProcess(_SYNCHRONIZE | _QUERY, False, process)
        if not handle:
            return ctypes.get_last_error() == _DENIED
        try:
            return kernel.WaitForSingleObject(handle, 0) == _RUNS
        finally:
            kernel.CloseHandle(handle)

    def _wait_for_end(parent: int, _pipe: IO[bytes]) -> None:
        """Wait for the parent's handle: a thread that reads a pipe keeps the libraries from loading."""
        kernel = _kernel()
        if handle := kernel.OpenProcess(_SYNCHRONIZE, False, parent):
            kernel.WaitForSingleObject(handle, _FOREVER)

    def start_without_ctrl_c(words: Sequence[str], stdin: int, stdout: int) -> "subprocess.Popen[bytes]":
        """Start a process that receives no Ctrl-C of the console. Raises: OSError."""
        return subprocess.Popen(words, creationflags=subprocess.CREATE_NEW_PROCESS_GROUP, stdin=stdin, stdout=stdout)

    def limit_memory(size_bytes: int) -> None:
        """Do nothing: Windows limits the memory of jobs alone."""

else:
    import signal

    def is_alive(process: int) -> bool:
        """Return True if a process of this number runs, of any user."""
        try:
            os.kill(process, 0)
        except ProcessLookupError:
            return False
        except PermissionError:
            return True
        return True

    def _wait_for_end(_parent: int, pipe: IO[bytes]) -> None:
        """Wait until the parent, which holds the other end of the pipe, is gone."""
        with suppress(OSError):
            while pipe.read(4096):
                pass

    def start_without_ctrl_c(words: Sequence[str], stdin: int, stdout: int) -> "subprocess.Popen[bytes]":
        """Start a process that receives no Ctrl-C of the terminal before it can ignore it. Raises: OSError.

        The calling thread itself receives none from then on.
        """
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        return subprocess.Popen(words, stdin=stdin, stdout=stdout)

    def limit_memory(size_bytes: int) -> None:
        """Let this process have no more memory than this: more is an error in it, and not the end of others."""
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (size_bytes, size_bytes))


def processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


def lower_priority(threads: set[int] | None = None, niceness: int = 10) -> None:
    """Give threads of this process a niceness; all of them if None. Only in Linux each thread has its own."""
    # Elsewhere a niceness would lower the whole process, also what somebody waits for.
    if sys.platform == "linux":
        for thread in all_threads() if threads is None else threads:
            with suppress(OSError):  # the thread has ended
                os.setpriority(os.PRIO_PROCESS, thread, niceness)


def all_threads() -> set[int]:
    """Return the system's numbers of this process's threads; none where the system does not list them."""
    tasks = Path("/proc/self/task")
    return {int(path.name) for path in tasks.iterdir()} if tasks.is_dir() else set()


def exit_with_parent(parent: int, pipe: IO[bytes], code: int = 0) -> None:
    """End this process as soon as its parent is gone; a thread in the background waits for that."""

    def leave() -> None:
        _wait_for_end(parent, pipe)
        os._exit(code)

    threading.Thread(target=leave, daemon=True).start()


def library_names(name: str, version: int) -> tuple[str, ...]:
    """Return the file names under which a library may be installed; `find_library` would start a compiler."""
    if sys.platform == "win32":
        return (f"lib{name}.dll", f"{name}.dll")
    if sys.platform == "darwin":
        return (f"lib{name}.{version}.dylib", f"lib{name}.dylib", f"/opt/homebrew/lib/lib{name}.dylib")
    return (f"lib{name}.so.{version}", f"lib{name}.so")


if sys.platform == "win32":
    import ctypes
    from ctypes import wintypes
    from typing import Any

    class _Counters(ctypes.Structure):
        """PROCESS_MEMORY_COUNTERS of psapi.h."""

        _fields_ = [
            ("cb", wintypes.DWORD),
            ("PageFaultCount", wintypes.DWORD),
            ("PeakWorkingSetSize", ctypes.c_size_t),
            ("WorkingSetSize", ctypes.c_size_t),
            *((f"quota{number}", ctypes.c_size_t) for number in range(4)),
            ("PagefileUsage", ctypes.c_size_t),
            ("PeakPagefileUsage", ctypes.c_size_t),
        ]

    def highest_bytes() -> int | None:
        """Return the largest memory that this process had, bytes; None if the system does not say."""
        kernel: Any = ctypes.WinDLL("kernel32")
        kernel.GetCurrentProcess.restype = ctypes.c_void_p
        counters = _Counters()
        counters.cb = ctypes.sizeof(counters)
        process = ctypes.c_void_p(kernel.GetCurrentProcess())
        is_known = kernel.K32GetProcessMemoryInfo(process, ctypes.byref(counters), counters.cb)
        return int(counters.PeakWorkingSetSize) if is_known else None

else:
    import resource

    _UNIT = 1 if sys.platform == "darwin" else 1024
    """`ru_maxrss` is in bytes on macOS and in kilobytes elsewhere (getrusage(2))."""

    def highest_bytes() -> int | None:
        """Return the largest memory that this process had, bytes; None if the system does not say."""
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * _UNIT
