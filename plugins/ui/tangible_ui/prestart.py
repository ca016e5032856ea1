"""The worker's process, started before the server is imported: both take half a second, and start in parallel."""

import subprocess
from collections.abc import Generator
from contextlib import contextmanager

from tangible_core.runtime import command

_prestarted: list[subprocess.Popen[bytes]] = []


def take_worker_process() -> subprocess.Popen[bytes]:
    """Return the prestarted process, or start another one; it waits for its folder on standard input."""
    return _prestarted.pop() if _prestarted else _start()


@contextmanager
def prestart_worker() -> Generator[None]:
    """Start a process for `take_worker_process`; at the end of the block, kill it if nobody took it."""
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
