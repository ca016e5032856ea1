"""How much memory a piece of work takes at its peak."""

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
    """Begin to watch; the function that comes back tells by how many bytes the process has grown at most since.

    On Linux the kernel's mark of the highest resident size is reset first (proc(5), `clear_refs`, and `VmHWM`), after
    what was freed has gone back to the system. `ru_maxrss` alone would not do: a child starts with its parent's mark,
    and the mark never falls. Elsewhere it is all there is, and growth below an earlier peak does not show;
    on Windows there is nothing: None.
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
    """How many bytes what a call gives keeps from others, as Python and NumPy count what they allocate.

    Exact and the same each time, unlike a process's size; what other libraries allocate by themselves does not show.
    """
    gc.collect()
    tracemalloc.start()
    try:
        made = make()
        gc.collect()
        held, _ = tracemalloc.get_traced_memory()
        del made
        return held
    finally:
        tracemalloc.stop()


def _reset() -> bool:
    with suppress(AttributeError):  # not glibc: nothing to give back by hand
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
