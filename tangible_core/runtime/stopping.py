"""Stopping long work from another thread: it looks, between its parts, whether it shall go on."""

from collections.abc import Generator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event

from ..errors import Stopped

_asked: ContextVar[Event | None] = ContextVar("tangible_stop", default=None)


@contextmanager
def stoppable(stop: Event | None) -> Generator[None]:
    """Work in this block ends with `Stopped`, soon after the event is set; None leaves an event of a block around it.

    >>> stop = Event()
    >>> stop.set()
    >>> with stoppable(stop):
    ...     check_stopped()
    Traceback (most recent call last):
    tangible_core.errors.Stopped: stopped by the program that asked for it; what was finished is kept
    """
    token = _asked.set(_asked.get() if stop is None else stop)
    try:
        yield
    finally:
        _asked.reset(token)


def stop_asked() -> bool:
    """Whether the work that this is part of shall end."""
    stop = _asked.get()
    return stop is not None and stop.is_set()


def check_stopped() -> None:
    """For long work, between its parts. Raises: Stopped if it shall end."""
    if stop_asked():
        raise Stopped
