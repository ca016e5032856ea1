"""The peak memory of a piece of work, and the memory that an object keeps."""

import ctypes
import gc
import tracemalloc
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tangible_core.runtime.system import highest_bytes

_STATUS, _CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")


def start_peak() -> Callable[[], int | None]:
    """Start to watch memory; return a function that returns the largest growth of the process since, in bytes."""
    # On Linux, the mark of the highest resident size is reset (proc(5), `clear_refs`). `ru_maxrss` is not enough:
    # a child starts with its parent's mark, which never falls. Elsewhere, growth below an earlier peak does not show.
    gc.collect()
    if _reset():
        before = _kernel_bytes("VmRSS")
        return lambda: max(0, _kernel_bytes("VmHWM") - before)
    if (before := highest_bytes()) is None:
        return lambda: None
    return lambda: (highest_bytes() or before) - before


def held_bytes(make: Callable[[], object]) -> int:
    """Return the bytes that the result of a call keeps, by Python's and NumPy's allocations, which repeat exactly."""
    gc.collect()
    tracemalloc.start()
    try:
        result = make()
        gc.collect()
        size, _ = tracemalloc.get_traced_memory()
        del result
        return size
    finally:
        tracemalloc.stop()


def _reset() -> bool:
    try:
        with suppress(AttributeError):  # not glibc: there is no such call
            ctypes.CDLL(None).malloc_trim(0)
        _CLEAR.write_text("5")
    except (OSError, TypeError):  # not Linux, and on Windows no library without a name
        return False
    return True


def _kernel_bytes(name: str) -> int:
    lines = _STATUS.read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(f"{name}:"))
