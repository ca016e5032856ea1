"""The table of all jobs by name, filled by the decorator at each."""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

F = TypeVar("F", bound=Callable[..., Any])


class Job(NamedTuple):
    """A job of the worker: called with the worker's state, and with the arguments of the server by name."""

    do: Callable[..., Any]
    quick: bool = False
    """True if it runs next to a long job rather than after it; it must then leave `WorkerState.pipeline` alone."""


JOBS: dict[str, Job] = {}


def job(*, quick: bool = False) -> Callable[[F], F]:
    """Register a function as the job of its name. Raises: ValueError if there is a job of this name."""

    def register(function: F) -> F:
        if function.__name__ in JOBS:
            raise ValueError(f"there are two jobs named {function.__name__}")
        JOBS[function.__name__] = Job(function, quick)
        return function

    return register
