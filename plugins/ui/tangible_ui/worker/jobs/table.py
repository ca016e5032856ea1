"""The table of all jobs by name, filled by the decorator at each."""

from collections.abc import Callable
from inspect import signature
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from tangible_core.errors import ConfigError, did_you_mean, quoted
from tangible_web.parsing import checked_arguments

F = TypeVar("F", bound=Callable[..., Any])


class Job(NamedTuple):
    """A job of the worker: called with the worker's state, and with the arguments of the server by name."""

    do: Callable[..., Any]
    # True if it runs next to a long job rather than after it; it must then leave `WorkerState.pipeline` alone.
    quick: bool = False
    page: bool = False  # true if it is a request of pages too, whose answer is its result


JOBS: dict[str, Job] = {}


def job(*, quick: bool = False, page: bool = False) -> Callable[[F], F]:
    """Register a function as the job of its name. page: it answers a request of pages by itself, quickly."""

    def register(function: F) -> F:
        if function.__name__ in JOBS:
            raise ValueError(f"there are two jobs named {function.__name__}")
        JOBS[function.__name__] = Job(function, quick or page, page)
        return function

    return register


@job(quick=True)
def answer_page(state: Any, text: str, path: Path, sets: list[str], request: str, arguments: dict[str, Any]) -> Any:
    """Answer a request of a page. Raises: ConfigError for an unknown one or wrong arguments; as the job."""
    answers = {name: entry.do for name, entry in JOBS.items() if entry.page}
    if request not in answers:
        raise ConfigError(f"there is no request {quoted(request)}{did_you_mean(request, answers)}")
    do = answers[request]
    own = (state, text, path, sets) if "text" in signature(do).parameters else (state,)
    return do(*own, **checked_arguments(request, do, len(own), arguments))
