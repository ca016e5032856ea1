"""A process that compiles kernels beside this one, which compiles others meanwhile.

numba compiles one kernel at a time in a process. The other process fills numba's cache on disk with what will be needed
later, and says what is ready. It is started when a kernel is compiled here, so that nothing is where all of them are
on disk, and it never outlives this one. No numba is imported here.
"""

import logging
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from types import TracebackType
from typing import IO, Any, NamedTuple, Self, final

from ..runtime.child_process import command, dumps
from ..runtime.stopping import check_stopped

log = logging.getLogger(__name__)
LOOK_EVERY_S = 0.1


class Work(NamedTuple):
    """What to do in the other process."""

    names: frozenset[str]
    """What can be waited for."""
    function: Callable[..., Iterator[str]]
    """Of a module; it gives each name when that is compiled."""
    arguments: tuple[Any, ...]


_waiting: "list[Beside]" = []


def kernels_are_compiled() -> None:
    """Called when a kernel of ours is compiled in this process: whatever waits for that begins."""
    for each in tuple(_waiting):
        each.begin()


@final
class Beside:
    """Compiles in a process of its own from the first kernel on that is compiled in this block, and no longer than it.

    Nothing depends on it but time: where no process can be started, or it fails, kernels are compiled here.
    """

    def __init__(self, work: Callable[[], Work | None]) -> None:
        """work: asked when it begins; None if there is nothing left to do."""
        self._work: Callable[[], Work | None] | None = work
        self._child: subprocess.Popen[bytes] | None = None
        self._due: frozenset[str] = frozenset()
        """What the process is still to compile."""
        self._lock, self._heard = threading.Lock(), threading.Condition()
        self._ear: threading.Thread | None = None

    def __enter__(self) -> Self:
        _waiting.append(self)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _waiting.remove(self)
        with self._lock:
            self._work = None
            child = self._child
        if child is not None:
            child.kill()
            child.wait()
            if self._ear is not None:
                self._ear.join()
            with suppress(OSError):  # what was not sent is not missed
                _pipe(child.stdin).close()
            _pipe(child.stdout).close()

    def begin(self) -> None:
        """Start the process, once, if there is work for it."""
        with self._lock:
            make, self._work = self._work, None
            if make is None:
                return
            try:
                if (work := make()) is None:
                    return
                data = dumps((work.function, work.arguments))
                self._child = subprocess.Popen(
                    command(__name__), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
                )
            except Exception as error:  # noqa: BLE001 - whatever a method of others cannot do: it is no use, no more
                log.debug("nothing is compiled in a process beside this one: %s", error)
                return
            self._due = work.names
            self._ear = threading.Thread(target=self._listen, args=(self._child, data), daemon=True)
            self._ear.start()

    def wait(self, what: str) -> None:
        """Until the process has compiled this; at once if it was not started, is gone, or does not compile this.

        Raises: Stopped if this work shall end.
        """
        with self._heard:
            while what in self._due:
                self._heard.wait(LOOK_EVERY_S)
                check_stopped()

    def _listen(self, child: "subprocess.Popen[bytes]", data: bytes) -> None:
        with suppress(OSError, ValueError):  # it is gone
            _pipe(child.stdin).write(data)
            _pipe(child.stdin).flush()
        for line in _pipe(child.stdout):
            with self._heard:
                self._due -= {line.decode(errors="replace").strip()}
                self._heard.notify_all()
        with self._heard:
            self._due = frozenset()
            self._heard.notify_all()


def _pipe(pipe: IO[bytes] | None) -> IO[bytes]:
    assert pipe is not None
    return pipe


def main() -> None:
    """In the process: do the work that comes over the standard input, and end when that ends."""
    work, arguments = pickle.load(sys.stdin.buffer)
    threading.Thread(target=_leave_with_the_other, daemon=True).start()
    for ready in work(*arguments):
        sys.stdout.write(f"{ready}\n")
        sys.stdout.flush()


def _leave_with_the_other() -> None:
    sys.stdin.buffer.read()
    os._exit(0)
