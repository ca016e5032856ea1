"""Work that may hang: what it is, said to a person once it has taken long."""

import logging
import threading
from collections.abc import Generator
from contextlib import contextmanager

LONG_S = 5.0


@contextmanager
def said_if_slow(log: logging.Logger, what: str) -> Generator[None]:
    """While this is open for longer than `LONG_S`, a warning says so, and how to end it."""
    timer = threading.Timer(LONG_S, log.warning, ["%s has taken %g s so far and goes on; Ctrl-C ends it", what, LONG_S])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
