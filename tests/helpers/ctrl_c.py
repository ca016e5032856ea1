"""Ctrl-C in tests, whatever runs them: what is started in the background or under nohup, and all that it starts,
begins with SIGINT and SIGQUIT ignored, and Python then raises no KeyboardInterrupt."""

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager

HEARING = (
    sys.executable,
    "-c",
    "import os, signal, sys; "
    "[signal.signal(each, signal.SIG_DFL) for each in (signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)]; "
    "os.execv(sys.argv[1], sys.argv[1:])",
)
"""Before the words of a command: it runs in the same process, and hears Ctrl-C."""


@contextmanager
def hearing() -> Iterator[None]:
    """This process hears Ctrl-C meanwhile."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
