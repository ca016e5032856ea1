"""Notes of methods about their decisions and doubts: logged, and kept with the result."""

import logging
from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar

from ..data import Note

_listener: ContextVar[Callable[[Note], None] | None] = ContextVar("tangible_notes", default=None)
_silent: ContextVar[bool] = ContextVar("tangible_notes_silent", default=False)


def note(log: logging.Logger, message: str, level: int = logging.INFO) -> None:
    """Log a decision, or from `logging.WARNING` on a warning, and keep it with the result that is being made.

    A kept note is shown again when the result comes from the cache, unlike a line that is only logged.
    """
    if _silent.get():
        return
    log.log(level, message)
    _keep(Note(message, "warning" if level >= logging.WARNING else "decision"))


def doubt(log: logging.Logger, message: str) -> None:
    """Note that a result is hardly worth feeling: a warning, after which `tangible feel` asks for confirmation."""
    if _silent.get():
        return
    log.warning(message)
    _keep(Note(message, "doubt"))


@contextmanager
def silently() -> Generator[None]:
    """Drop all notes of this block, such as those of a film, which repeat with every frame."""
    token = _silent.set(True)
    try:
        yield
    finally:
        _silent.reset(token)


@contextmanager
def collect_notes() -> Generator[list[Note]]:
    """Collect the notes of all methods that run in this block, in order."""
    notes: list[Note] = []
    with _listening(notes.append):
        yield notes


@contextmanager
def collected() -> Generator[list[str]]:
    """Collect the texts of these notes.

    >>> with collected() as notes:
    ...     note(logging.getLogger("doctest"), "skipped: the views are identical")
    >>> notes
    ['skipped: the views are identical']
    """
    texts: list[str] = []
    with _listening(lambda each: texts.append(each.text)):
        yield texts


@contextmanager
def _listening(listener: Callable[[Note], None]) -> Generator[None]:
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def _keep(message: Note) -> None:
    if (listener := _listener.get()) is not None:
        listener(message)
