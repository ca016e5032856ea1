"""Stopping of long work from another thread: the work checks between its parts whether to go on."""

import logging
import threading
from collections.abc import Generator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event

from ..errors import Stopped

_stop: ContextVar[Event | None] = ContextVar("tangible_stop", default=None)


@contextmanager
def stoppable(stop: Event | None) -> Generator[None]:
    """End work in this block with `Stopped` soon after the event is set; None keeps the event of an outer block.

    >>> stop = Event()
    >>> stop.set()
    >>> with stoppable(stop):
    ...     check_stopped()
    Traceback (most recent call last):
    tangible_core.errors.Stopped: stopped on request; what was finished is kept
    """
    token = _stop.set(_stop.get() if stop is None else stop)
    try:
        yield
    finally:
        _stop.reset(token)


def stop_asked() -> bool:
    """Return True if the current work shall end."""
    stop = _stop.get()
    return stop is not None and stop.is_set()


def check_stopped() -> None:
    """Raise `Stopped` if the current work shall end; long work calls this between its parts."""
    if stop_asked():
        raise Stopped


LONG_S = 5.0


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
