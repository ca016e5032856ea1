"""A force loop in a thread of this process, where `Servo` starts a process: all that a loop does, but no Python.

The host speaks to it over two pipes as to a process, and it takes scenes out of the same shared memory. Tests of
signals, of kills, of laws that block and of what a process leaves behind need the process.
"""

import copyreg
import io
import os
import signal
import subprocess
import threading
from contextlib import closing
from types import SimpleNamespace

import pytest

from tangible_core.runtime.system import priority
from tangible_core.servo import child, limits, supervisor

ENDING_S = 120.0
"""Longer than a loop takes to compile what it needs on a busy machine, before it hears that it is to end."""


class LoopThread(subprocess.Popen[bytes]):
    """The part of `Popen` that the host of a loop uses; no process is started."""

    pid = os.getpid()

    def __init__(self, *_: object, **__: object) -> None:
        (commands, told), (said, replies) = os.pipe(), os.pipe()
        self.stdin, self.stdout = os.fdopen(told, "wb"), os.fdopen(said, "rb")
        self._commands, self._replies = _Commands(commands), os.fdopen(replies, "wb")
        self._killed = False
        self._thread = threading.Thread(target=self._live, daemon=True)
        self._thread.start()

    def _live(self) -> None:
        try:
            with closing(self._commands), self._replies:
                child.Child(self._commands, self._replies).main()
        except ValueError:  # its pipe was closed under it
            if not self._killed:
                raise

    def poll(self) -> int | None:
        return -signal.SIGKILL if self._killed else None if self._thread.is_alive() else 0

    def wait(self, timeout: float | None = None) -> int:
        self._thread.join(timeout)
        if self._thread.is_alive():
            raise subprocess.TimeoutExpired("a loop in a thread", timeout or 0)
        return 0

    def kill(self) -> None:
        """End without a last word, as a killed process; a law or a device that blocks needs a real one."""
        self._killed = True
        self._replies.close()
        self.stdin.close()


class _Commands(io.FileIO):
    """A pipe that is closed while another thread would read on: that thread finds it at its end."""

    def __init__(self, descriptor: int) -> None:
        super().__init__(descriptor)
        self._one = threading.Lock()

    def read(self, size: int | None = -1, /) -> bytes:
        with self._one:
            return b"" if self.closed else super().read(size) or b""

    def close(self) -> None:
        with self._one:
            super().close()


def loops_in_threads(patch: pytest.MonkeyPatch) -> None:
    """Start each loop in a thread from now on; it locks no memory, and leaves collecting garbage alone."""
    patch.setattr(supervisor, "start_without_ctrl_c", LoopThread)
    patch.setattr(limits, "KILL_S", ENDING_S)
    patch.setattr(child, "gc", SimpleNamespace(freeze=lambda: None, collect=lambda: None))
    asked = priority._c
    patch.setattr(priority, "_c", lambda name: (lambda *_: -1) if name == "mlockall" else asked(name))
    # A loop's process has not imported distributed, which teaches pickle every error that there is.
    errors = [each for each in copyreg.dispatch_table if isinstance(each, type) and issubclass(each, BaseException)]
    for error in errors:
        patch.delitem(copyreg.dispatch_table, error)
