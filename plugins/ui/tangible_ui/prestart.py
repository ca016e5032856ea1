"""The maker's process, started before the server itself is imported: each takes half a second, side by side."""

import subprocess
from collections.abc import Generator
from contextlib import contextmanager

from tangible_core.runtime.child_process import command

_started: list[subprocess.Popen[bytes]] = []


def maker_process() -> subprocess.Popen[bytes]:
    """The one that was started beforehand, or another one; it waits for its folder on standard input."""
    return _started.pop() if _started else _start()


@contextmanager
def maker_beforehand() -> Generator[None]:
    """Start one that `maker_process` then gives; it is ended if nobody asked for it."""
    _started.append(_start())
    try:
        yield
    finally:
        while _started:
            with _started.pop() as process:
                process.kill()


def _start() -> subprocess.Popen[bytes]:
    pipe = subprocess.PIPE
    return subprocess.Popen(command("tangible_ui.worker.process"), stdin=pipe, stdout=pipe, stderr=pipe)
