"""Tests that run side by side in several processes compile each kernel once: the second waits, and finds it on disk."""

import fcntl
from pathlib import Path
from typing import Any


def compile_once() -> None:
    """Lock the file in which a kernel stands, wherever numba would compile one that is kept on disk."""
    from numba.core.compiler_lock import global_compiler_lock
    from numba.core.dispatcher import Dispatcher

    compile_anyway = Dispatcher.compile
    locked: set[str] = set()

    def compile_first(self: Any, sig: Any) -> Any:
        source = self.py_func.__code__.co_filename
        if source in locked or not self.stats.cache_path:
            return compile_anyway(self, sig)
        # numba's own lock first, as whoever compiles a kernel holds it when it comes to those that are called
        with global_compiler_lock, Path(source).open() as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            locked.add(source)
            try:
                return compile_anyway(self, sig)
            finally:
                locked.remove(source)

    Dispatcher.compile = compile_first
