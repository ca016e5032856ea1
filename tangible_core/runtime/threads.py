"""How many threads work at once, whoever has them: our kernels, OpenCV, torch."""

import os
from collections.abc import Callable, Generator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from contextvars import ContextVar

from ..errors import ConfigError, quoted, wrong_argument

VARIABLE = "TANGIBLE_THREADS"
limiters: list[Callable[[int], AbstractContextManager[None]]] = []
"""(most) -> a block in which a library has no more threads; each is put here by the module that uses that library."""
_asked: ContextVar[int | None] = ContextVar("tangible_threads", default=None)


@contextmanager
def limited_threads(most: int | None = None) -> Generator[None]:
    """In this block so many threads work at most; None leaves the limit around it, or that of `TANGIBLE_THREADS`.

    Results do not depend on it. Raises: ArgumentError for what is no number of threads, ConfigError as `thread_limit`.
    """
    check_threads(most)
    limit = thread_limit() if most is None else most
    if limit is None or limit == _asked.get():
        yield
        return
    token = _asked.set(limit)
    try:
        with ExitStack() as libraries:
            for each in limiters:
                libraries.enter_context(each(limit))
            yield
    finally:
        _asked.reset(token)


def check_threads(most: object) -> None:
    """Raises: ArgumentError for what is no number of threads, nor None."""
    if most is not None and (not isinstance(most, int) or isinstance(most, bool) or most < 1):
        raise wrong_argument("threads", most, "a whole number from 1, or None for no limit")


def thread_limit() -> int | None:
    """The most threads in this block, or by `TANGIBLE_THREADS`; None where nobody says one.

    Raises: ConfigError if that variable holds no number of threads.
    """
    if (asked := _asked.get()) is not None:
        return asked
    said = os.environ.get(VARIABLE, "").strip()
    if not said:
        return None
    if not (said.isascii() and said.isdigit() and int(said) > 0):
        raise ConfigError(f"{VARIABLE}: is {quoted(said)}; set it to a whole number of threads from 1, or unset it")
    return int(said)


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
