"""A background process that fills numba's disk cache with later kernels while this one compiles others."""

import gc
import logging
import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, NamedTuple, Self, final

from ..runtime.child_process import command, dumps, pipe_end
from ..runtime.stopping import check_stopped
from ..runtime.system.processes import exit_with_parent

log: logging.Logger = logging.getLogger(__name__)
LATE_STEPS = "late steps of the depth"
"""The name of the steps that `DepthEstimator.rehearse` runs."""
LOOK_EVERY_S = 0.1  # the period, s, at which a waiting thread checks whether it shall stop
LONGEST_S = 300.0  # the longest wait for one kernel, s; the slowest takes a tenth of it


class Work(NamedTuple):
    """The work of the background process."""

    names: frozenset[str]
    """The names that can be waited for."""
    function: Callable[..., Iterator[str]]
    """A function of a module that yields each name once its kernels are compiled."""
    arguments: tuple[Any, ...]


_waiting: "list[BackgroundCompiler]" = []


def start_waiting() -> None:
    """Start the waiting background compilers; called when a kernel is compiled in this process."""
    for compiler in tuple(_waiting):
        compiler.begin()


def wait_for(what: str) -> None:
    """Wait until this is compiled wherever a background process compiles it. Raises: Stopped."""
    for compiler in tuple(_waiting):
        compiler.wait(what)


@final
class BackgroundCompiler:
    """A block with a process that compiles in the background, from the first kernel compiled in it to its end."""

    def __init__(self, work: Callable[[], Work | None]) -> None:
        """Prepare the block; work: called when the process starts, returns None if there is nothing to do."""
        self._work: Callable[[], Work | None] | None = work
        self._child: subprocess.Popen[bytes] | None = None
        self._due: frozenset[str] = frozenset()
        """The names that the process has yet to compile."""
        self._lock, self._progress = threading.Lock(), threading.Condition()
        self._listener: threading.Thread | None = None

    def __enter__(self) -> Self:
        _waiting.append(self)
        return self

    def __exit__(self, *_: object) -> None:
        _waiting.remove(self)
        with self._lock:
            self._work = None
            child = self._child
        if child is not None:
            child.kill()
            child.wait()
            if self._listener is not None:
                self._listener.join()
            with suppress(OSError):  # unsent data are not needed
                pipe_end(child.stdin).close()
            pipe_end(child.stdout).close()

    def begin(self) -> None:
        """Start the process, once, if there is work for it."""
        with self._lock:
            make, self._work = self._work, None
            if make is None:
                return
            try:
                if (work := make()) is None:
                    return
                data = dumps((os.getpid(), work.function, work.arguments))
                self._child = subprocess.Popen(
                    command(__name__), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
                )
            except Exception as error:  # noqa: BLE001 - any fault of a plugin only costs the background process
                log.debug("nothing is compiled in the background: %s", error)
                return
            self._due = work.names
            self._listener = threading.Thread(target=self._listen, args=(self._child, data), daemon=True)
            self._listener.start()

    def wait(self, what: str) -> None:
        """Wait until the process has compiled this; return at once if it is not running or does not compile this."""
        with self._progress:
            until_s = time.monotonic() + LONGEST_S
            while what in self._due and time.monotonic() < until_s:
                self._progress.wait(LOOK_EVERY_S)
                check_stopped()
            if what in self._due:
                log.warning("the process that compiles in the background stands still; %s is compiled here", what)
                self._due = frozenset()

    def _listen(self, child: "subprocess.Popen[bytes]", data: bytes) -> None:
        with suppress(OSError, ValueError):  # the process has ended
            pipe_end(child.stdin).write(data)
            pipe_end(child.stdin).flush()
        for line in pipe_end(child.stdout):
            with self._progress:
                self._due -= {line.decode(errors="replace").strip()}
                self._progress.notify_all()
        with self._progress:
            self._due = frozenset()
            self._progress.notify_all()


def main() -> None:
    """Do the work that arrives on standard input, in the background process, and end when that is closed."""
    gc.disable()  # the process ends soon
    parent, work, arguments = pickle.load(sys.stdin.buffer)
    exit_with_parent(parent, sys.stdin.buffer)
    for ready in work(*arguments):
        sys.stdout.write(f"{ready}\n")
        sys.stdout.flush()
