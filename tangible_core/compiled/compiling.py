"""Options for compiling kernels, and a notice while they are compiled, which takes seconds, once on a machine."""

import gc
import logging
from collections.abc import Callable
from time import perf_counter
from typing import Any, cast

from numba import njit as _njit
from numba.core import event
from numba.core.caching import FunctionCache
from numba.core.dispatcher import Dispatcher
from numba.extending import overload, register_jitable

from .background import start_waiting

log: logging.Logger = logging.getLogger(__name__)
# The time that is left, once a second, for those who show it: a terminal's line, a page. Nobody else hears of it.
progress_log: logging.Logger = log.getChild("progress")
progress_log.propagate = False
# The bytes of bytecode that a process of a first `tangible demo` compiles, by family: time is proportional to them.
BYTECODE = {"depth": 28_500, "texture": 3_700, "render": 10_600, "core": 14_000}

njit: Any = _njit
"""Numba's decorator. What it returns is called from Python and from kernels, with types that no checker knows."""
KERNEL: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
"""The options of a kernel that allocates no arrays: it does not count references, which would be two atomic operations
for each array and call; it has no entry point for C, because nothing uses that."""
INNER: dict[str, Any] = {**KERNEL, "cache": False, "no_cpython_wrapper": True}


def inner(**options: Any) -> Any:
    """Decorate a function that only kernels call: it is compiled with them, without an entry point for Python.

    This halves the compile time of a small kernel. Called from Python, the function runs as plain Python.
    """
    return register_jitable(**{**INNER, **options})


def inner_by_type(choose: Callable[..., Callable[..., Any]]) -> Any:
    """Decorate a function like `inner` whose implementation `choose` selects by numba's types of the arguments."""

    def decorate(function: Callable[..., Any]) -> Any:
        overload(function, jit_options=cast(Any, INNER), strict=False)(choose)
        return function

    return decorate


class _CompileNotice(event.Listener):
    """A listener that logs once for each family of plugins that kernels are compiled, and the time this takes here.

    A family's default methods need the same time for each byte of bytecode, within a fifth: the time follows from the
    first compiled function, and what is left from all that are compiled.
    """

    def __init__(self) -> None:
        self.compiled: dict[str, int] = {}
        """The bytes of bytecode that are compiled of each package."""
        self._starts_s: list[float] = []
        self._began_s: dict[str, float] = {}
        self._reported_s = 0.0

    def on_start(self, event: Any) -> None:
        package = _package(_function(event))
        if package.startswith("tangible_"):
            start_waiting()
        if not self.compiled:
            event.data["dispatcher"].targetctx.refresh()  # numba prepares itself once; do not measure it
        self._starts_s.append(perf_counter())
        self._began_s.setdefault(package, self._starts_s[-1])

    def on_end(self, event: Any) -> None:
        function, now_s = _function(event), perf_counter()
        size, took_s = len(function.__code__.co_code), now_s - self._starts_s.pop()
        package = _package(function)
        if not package.startswith("tangible_"):
            return
        is_first = package not in self.compiled
        self.compiled[package] = self.compiled.get(package, 0) + size
        kind = package.removeprefix("tangible_")
        all_bytes = BYTECODE.get(kind, 0)
        if is_first:
            takes = f"about {max(1, round(took_s / size * all_bytes))} s" if all_bytes else "seconds"
            log.info("compiling the %s kernels for this processor, %s; later runs find them on disk", kind, takes)
        elif now_s - self._reported_s >= 1 and (left := all_bytes - self.compiled[package]) > 0:
            self._reported_s = now_s
            left_s = (now_s - self._began_s[package]) / self.compiled[package] * left
            share = self.compiled[package] / all_bytes
            progress_log.info("about %d s left", max(1, round(left_s)), extra={"share": share})


def _package(function: Any) -> str:
    return function.__module__.partition(".")[0]


def _function(event: Any) -> Any:
    return event.data["dispatcher"].py_func


class _GarbageCollectionPause(event.Listener):
    """A listener that pauses garbage collection while a kernel is compiled, which saves a fifteenth of the time."""

    def __init__(self) -> None:
        self._depth = 0
        self._was_enabled = False

    def on_start(self, event: Any) -> None:
        if not self._depth:
            self._was_enabled = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        if not self._depth and self._was_enabled:
            gc.enable()


_dispatchers: Any = Dispatcher
_enable_caching = _dispatchers.enable_caching


class _KernelCache(FunctionCache):
    """The disk cache of a kernel that does not use numba's runtime: memory, strings, hashes.

    Before numba loads a function from its disk cache, it imports 72 modules of its own and SciPy's linear algebra, and
    registers thousands of implementations: half a second, more than the import of numba. The function is machine code
    by then, so that a process which compiles nothing saves this time. The first compilation does all of it by itself.
    """

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load the compiled kernel for this signature; None if it is not on the disk."""
        cache: Any = self
        with cache._guard_against_spurious_io_errors():
            return cache._load_overload(sig, target_context)


def _enable_kernel_caching(dispatcher: Any) -> None:
    _enable_caching(dispatcher)
    if dispatcher.targetoptions.get("_nrt") is False and type(dispatcher._cache) is FunctionCache:
        dispatcher._cache.__class__ = _KernelCache


_dispatchers.enable_caching = _enable_kernel_caching
for _listener in (_CompileNotice(), _GarbageCollectionPause()):
    event.register("numba:compile", _listener)  # pyright: ignore[reportUnknownMemberType]
