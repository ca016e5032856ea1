"""How many threads may work at once, and who said so."""

import os
from contextvars import ContextVar

from ..errors import ConfigError, quoted, wrong_argument

VARIABLE = "TANGIBLE_THREADS"
asked: ContextVar[int | None] = ContextVar("tangible_threads", default=None)
"""The limit of the block around this; see `threads.limited_threads`."""


def check_threads(most: object) -> None:
    """Raises: ArgumentError for what is no number of threads, nor None."""
    if most is not None and (not isinstance(most, int) or isinstance(most, bool) or most < 1):
        raise wrong_argument("threads", most, "a whole number from 1, or None for no limit")


def thread_limit() -> int | None:
    """The most threads in this block, or by `TANGIBLE_THREADS`; None where nobody says one.

    Raises: ConfigError if that variable holds no number of threads.
    """
    if (within := asked.get()) is not None:
        return within
    said = os.environ.get(VARIABLE, "").strip()
    if not said:
        return None
    if not (said.isascii() and said.isdigit() and int(said) > 0):
        raise ConfigError(f"{VARIABLE}: is {quoted(said)}; set it to a whole number of threads from 1, or unset it")
    return int(said)


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
