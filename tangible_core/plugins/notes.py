"""What a method decided, left out or doubts: said in the log, and kept with its result for whoever asks."""

import logging
from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar

from ..data import Note

_told: ContextVar[Callable[[Note], None] | None] = ContextVar("tangible_notes", default=None)
_silent: ContextVar[bool] = ContextVar("tangible_notes_silent", default=False)


def note(log: logging.Logger, message: str, level: int = logging.INFO) -> None:
    """Log a decision, or from `logging.WARNING` on a warning, and keep it with the result that is being made.

    What is kept is told again when the result comes from the cache; what is only logged is not.
    """
    if _silent.get():
        return
    log.log(level, message)
    _keep(Note(message, "warning" if level >= logging.WARNING else "decision"))


def doubt(log: logging.Logger, message: str) -> None:
    """`note` that a result is hardly worth feeling: a warning, on which `tangible feel` asks first."""
    if _silent.get():
        return
    log.warning(message)
    _keep(Note(message, "doubt"))


@contextmanager
def silently() -> Generator[None]:
    """Nothing that is noted in this block is said or kept: frame after frame of a film, it would be the same again."""
    token = _silent.set(True)
    try:
        yield
    finally:
        _silent.reset(token)


@contextmanager
def noted() -> Generator[list[Note]]:
    """The notes of all methods that run in this block, in order."""
    notes: list[Note] = []
    with _heard(notes.append):
        yield notes


@contextmanager
def collected() -> Generator[list[str]]:
    """The texts of these notes.

    >>> with collected() as notes:
    ...     note(logging.getLogger("doctest"), "skipped: the views are identical")
    >>> notes
    ['skipped: the views are identical']
    """
    texts: list[str] = []
    with _heard(lambda each: texts.append(each.text)):
        yield texts


@contextmanager
def _heard(tell: Callable[[Note], None]) -> Generator[None]:
    token = _told.set(tell)
    try:
        yield
    finally:
        _told.reset(token)


def _keep(made: Note) -> None:
    if (tell := _told.get()) is not None:
        tell(made)
