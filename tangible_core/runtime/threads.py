"""How many threads work at once, whoever has them: our kernels, OpenCV, torch."""

from collections.abc import Generator
from contextlib import ExitStack, contextmanager

from .opencv import opencv_at_most
from .thread_limit import asked, check_threads, thread_limit
from .torch_extra import torch_at_most


@contextmanager
def limited_threads(most: int | None = None) -> Generator[None]:
    """In this block so many threads work at most; None leaves the limit around it, or that of `TANGIBLE_THREADS`.

    Results do not depend on it. Raises: ArgumentError for what is no number of threads, ConfigError as `thread_limit`.
    """
    check_threads(most)
    limit = thread_limit() if most is None else most
    if limit is None or limit == asked.get():
        yield
        return
    token = asked.set(limit)
    try:
        with ExitStack() as libraries:
            libraries.enter_context(opencv_at_most(limit))
            libraries.enter_context(torch_at_most(limit))
            yield
    finally:
        asked.reset(token)
