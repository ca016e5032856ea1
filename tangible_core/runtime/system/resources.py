"""What the system calls a library's file, and the most memory that this process had."""

import sys


def library_names(name: str, version: int) -> tuple[str, ...]:
    """Return the file names under which a library may be installed; `find_library` would start a compiler.

    version: of its binary interface.
    """
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
        found = kernel.K32GetProcessMemoryInfo(process, ctypes.byref(counters), counters.cb)
        return int(counters.PeakWorkingSetSize) if found else None

else:
    import resource

    _UNIT = 1 if sys.platform == "darwin" else 1024
    """`ru_maxrss` is in bytes on macOS and in kilobytes elsewhere (getrusage(2))."""

    def highest_bytes() -> int | None:
        """Return the largest memory that this process had, bytes; None if the system does not say."""
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * _UNIT
