"""What a method decided or left out: said in the log, and kept for whoever asks, such as a benchmark."""

import logging
from collections.abc import Generator
from contextlib import contextmanager
from contextvars import ContextVar

_asked: ContextVar[list[str] | None] = ContextVar("tangible_notes", default=None)


def note(log: logging.Logger, message: str, level: int = logging.INFO) -> None:
    """Log a decision, and hand it to `collected` where that is open."""
    log.log(level, message)
    if (notes := _asked.get()) is not None:
        notes.append(message)


@contextmanager
def collected() -> Generator[list[str]]:
    """The notes of all methods that run in this block, in order.

    >>> with collected() as notes:
    ...     note(logging.getLogger("doctest"), "skipped: the views are identical")
    >>> notes
    ['skipped: the views are identical']
    """
    notes: list[str] = []
    token = _asked.set(notes)
    try:
        yield notes
    finally:
        _asked.reset(token)
