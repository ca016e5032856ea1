"""The worker's process, started before the server itself is imported: each takes half a second, side by side."""

import subprocess
from collections.abc import Generator
from contextlib import contextmanager

from tangible_core.runtime.child_process import command

_prestarted: list[subprocess.Popen[bytes]] = []


def take_worker_process() -> subprocess.Popen[bytes]:
    """The one that was started beforehand, or another one; it waits for its folder on standard input."""
    return _prestarted.pop() if _prestarted else _start()


@contextmanager
def prestart_worker() -> Generator[None]:
    """Start one that `take_worker_process` then gives; it is ended if nobody asked for it."""
    _prestarted.append(_start())
    try:
        yield
    finally:
        while _prestarted:
            with _prestarted.pop() as process:
                process.kill()


def _start() -> subprocess.Popen[bytes]:
    pipe = subprocess.PIPE
    return subprocess.Popen(command("tangible_ui.worker.process"), stdin=pipe, stdout=pipe, stderr=pipe)
