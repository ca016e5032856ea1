"""A warning for work that takes long and may hang."""

import logging
import threading
from collections.abc import Generator
from contextlib import contextmanager

LONG_S = 5.0
"""The time until the warning, s."""


@contextmanager
def warn_if_slow(log: logging.Logger, what: str) -> Generator[None]:
    """Log a warning, with the way to end the work, if this block takes longer than `LONG_S`."""
    timer = threading.Timer(LONG_S, log.warning, ["%s has taken %g s so far and goes on; Ctrl-C ends it", what, LONG_S])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
