"""The peak memory of a piece of work, and the memory that an object keeps."""

import ctypes
import gc
import sys
import tracemalloc
from collections.abc import Callable
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

_STATUS, _CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")
_UNIT = 1 if sys.platform == "darwin" else 1024
"""`ru_maxrss` is in bytes on macOS and in kilobytes elsewhere (getrusage(2))."""


def start_peak() -> Callable[[], int | None]:
    """Start to watch memory; return a function that returns the largest growth of the process since, in bytes.

    On Linux, freed memory is given back to the system and the kernel's mark of the highest resident size is reset
    (proc(5), `clear_refs`, and `VmHWM`). `ru_maxrss` is not enough: a child starts with its parent's mark, and the
    mark never falls. On other systems there is only `ru_maxrss`, where growth below an earlier peak does not show; on
    Windows there is nothing, and the function returns None.
    """
    gc.collect()
    if sys.platform == "linux" and _reset():
        before = _kernel_bytes("VmRSS")
        return lambda: max(0, _kernel_bytes("VmHWM") - before)
    if find_spec("resource") is None:
        return lambda: None
    before = _highest()
    return lambda: _highest() - before


def held_bytes(make: Callable[[], object]) -> int:
    """Return the number of bytes that the result of a call keeps, as Python and NumPy count their allocations.

    Unlike the size of a process, it is exact and repeatable; allocations of other libraries do not show.
    """
    gc.collect()
    tracemalloc.start()
    try:
        result = make()
        gc.collect()
        held, _ = tracemalloc.get_traced_memory()
        del result
        return held
    finally:
        tracemalloc.stop()


def _reset() -> bool:
    with suppress(AttributeError):  # not glibc: there is no such call
        ctypes.CDLL(None).malloc_trim(0)
    try:
        _CLEAR.write_text("5")
    except OSError:
        return False
    return True


def _kernel_bytes(name: str) -> int:
    lines = _STATUS.read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(f"{name}:"))


def _highest() -> int:
    import resource  # not on Windows

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * _UNIT
