"""How kernels are compiled, and a word while they are, which takes seconds, once a machine.

A room of kernels imports this module.
"""

import gc
import logging
from collections.abc import Callable
from time import perf_counter
from typing import Any, cast

from numba.core import event
from numba.extending import overload, register_jitable

from .background import kernels_are_compiled
from .loading import load_kernels_alone

log = logging.getLogger(__name__)
BYTECODE = {"depth": 36_000, "texture": 3_700, "render": 10_600, "core": 14_000}
"""Bytes of bytecode that a first `tangible demo` compiles of each family: its time is in proportion to them."""

KERNEL: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
"""Options of a kernel that is given all its arrays and makes none: it counts no references to them, each of which is an
atomic operation, twice an array and call. Nobody calls one by C's convention, so that no way in for it is compiled."""


INNER: dict[str, Any] = {**KERNEL, "cache": False, "no_cpython_wrapper": True}
"""The same for a function that only kernels call."""


def inner(**options: Any) -> Any:
    """Of a function that only kernels call: it is compiled with them, without what Python would call it through.

    That is half of what a small kernel takes to compile. Called from Python, it runs as plain Python.
    """
    return register_jitable(**{**INNER, **options})


def inner_by_type(choose: Callable[..., Callable[..., Any]]) -> Any:
    """As `inner`, of a function that is another one for other types: `choose` is given numba's, and gives it."""

    def chosen(called: Callable[..., Any]) -> Any:
        overload(called, jit_options=cast(Any, INNER), strict=False)(choose)
        return called

    return chosen


class _CompileNotice(event.Listener):
    """Reports once a process and family of plugins that kernels are being compiled, and how long that takes here.

    The first function that is compiled is measured: of the family's default methods all takes as long for each byte
    of bytecode, within a fifth.
    """

    def __init__(self) -> None:
        self.reported: set[str] = set()
        self._starts_s: list[float] = []

    def on_start(self, event: Any) -> None:
        if _function(event).__module__.startswith("tangible_"):
            kernels_are_compiled()
        if not self.reported:
            event.data["dispatcher"].targetctx.refresh()  # numba prepares itself once, which is not the function's time
        self._starts_s.append(perf_counter())

    def on_end(self, event: Any) -> None:
        function, took_s = _function(event), perf_counter() - self._starts_s.pop()
        package = function.__module__.partition(".")[0]
        if not package.startswith("tangible_") or package in self.reported:
            return
        self.reported.add(package)
        kind = package.removeprefix("tangible_")
        all_s = took_s / len(function.__code__.co_code) * BYTECODE.get(kind, 0)
        takes = f"about {max(1, round(all_s))} s" if kind in BYTECODE else "seconds"
        log.info("compiling the %s kernels for this processor, %s; later runs find them on disk", kind, takes)


def _function(event: Any) -> Any:
    """The Python function that an event of numba's is about."""
    return event.data["dispatcher"].py_func


class _Unswept(event.Listener):
    """Holds Python's garbage collector off while a kernel is compiled, a fifteenth of the time of which it would take.

    Within the lock that numba compiles under, so that there is one at a time.
    """

    def __init__(self) -> None:
        self._within = 0
        self._swept = False

    def on_start(self, event: Any) -> None:
        if not self._within:
            self._swept = gc.isenabled()
            gc.disable()
        self._within += 1

    def on_end(self, event: Any) -> None:
        self._within -= 1
        if not self._within and self._swept:
            gc.enable()


load_kernels_alone()
for _listener in (_CompileNotice(), _Unswept()):
    event.register("numba:compile", _listener)  # pyright: ignore[reportUnknownMemberType]
