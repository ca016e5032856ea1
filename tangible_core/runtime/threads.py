"""The limit on the number of working threads, for our kernels, OpenCV and torch."""

import os
from collections.abc import Callable, Generator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from contextvars import ContextVar

from ..errors import ConfigError, quoted, wrong_argument

VARIABLE = "TANGIBLE_THREADS"
# Functions (most) -> a block in which a library has at most that many threads; modules register theirs here.
limiters: list[Callable[[int], AbstractContextManager[None]]] = []
_limit: ContextVar[int | None] = ContextVar("tangible_threads", default=None)


@contextmanager
def limited_threads(most: int | None = None) -> Generator[None]:
    """Limit the threads in this block; None keeps the limit of an outer block, or of `TANGIBLE_THREADS`."""
    check_threads(most)
    limit = thread_limit() if most is None else most
    if limit is None or limit == _limit.get():
        yield
        return
    token = _limit.set(limit)
    try:
        with ExitStack() as libraries:
            for limiter in limiters:
                libraries.enter_context(limiter(limit))
            yield
    finally:
        _limit.reset(token)


def check_threads(most: object) -> None:
    """Raise an ArgumentError if a value is neither a number of threads nor None."""
    if most is not None and (not isinstance(most, int) or isinstance(most, bool) or most < 1):
        raise wrong_argument("threads", most, "a whole number from 1, or None for no limit")


def thread_limit() -> int | None:
    """Return the limit on threads in this block, or of `TANGIBLE_THREADS`; None without a limit."""
    if (limit := _limit.get()) is not None:
        return limit
    text = os.environ.get(VARIABLE, "").strip()
    if not text:
        return None
    if not (text.isascii() and text.isdigit() and int(text) > 0):
        raise ConfigError(f"{VARIABLE}: is {quoted(text)}; set it to a whole number of threads from 1, or unset it")
    return int(text)
