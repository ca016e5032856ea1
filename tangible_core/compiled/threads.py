"""Threads for kernels that release the GIL.

No OpenMP: its idle threads spin and take the processor from whoever works.
"""

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import suppress
from contextvars import copy_context
from functools import cache
from itertools import pairwise
from typing import Any, TypeVar

from ..runtime.stopping import check_stopped
from ..runtime.threads import processors, thread_limit
from . import compiling as compiling  # says so while the kernels are compiled

T = TypeVar("T")


def thread_count() -> int:
    """How many threads to work on: one a processor, within the limit of `runtime.threads`."""
    return min(processors(), thread_limit() or processors())


def run_all(jobs: Iterable[Callable[[], Any]]) -> None:
    """Run every job and wait; the calling thread does the first. A job must not call `run_all` itself.

    There are no more jobs than `thread_count` says: each gets a thread.
    Raises: Stopped before any job if the caller's work shall end; a job sees that as well as its caller does. What the
    calling thread raises, such as an interrupt, comes before what it brings about in the others.
    """
    check_stopped()
    first, *rest = jobs
    waiting = [_pool(os.getpid()).submit(copy_context().run, each) for each in rest]
    try:
        first()
    finally:
        wait(waiting)
    for each in waiting:
        each.result()


def in_blocks(length: int, work: Callable[[int, int], Any], at_least: int = 16) -> None:
    """work(start, stop) on about equal parts of range(length), one a thread, none much shorter than `at_least`."""
    parts = max(1, min(thread_count(), length // at_least))
    edges = [i * length // parts for i in range(parts + 1)]
    run_all([lambda a=a, b=b: work(a, b) for a, b in pairwise(edges)])


def in_turns(tasks: list[T], work: Callable[[Iterable[T]], Any], most: int | None = None) -> None:
    """work(share) in up to `most` threads, which take the tasks in their order, each the next when it is done with one.

    Raises: Stopped between two tasks if the caller's work shall end.
    """
    parts = min(thread_count(), len(tasks), len(tasks) if most is None else most)
    if parts:
        left = deque(tasks)
        run_all([lambda: work(_taken(left)) for _ in range(parts)])


def _taken(left: deque[T]) -> Iterator[T]:
    """What nobody else takes of it; other threads may empty it between a look and the taking."""
    with suppress(IndexError):
        while left:
            check_stopped()
            yield left.popleft()


@cache
def _pool(process: int) -> ThreadPoolExecutor:
    """A pool a process: threads do not survive a fork."""
    return ThreadPoolExecutor(processors(), thread_name_prefix="tangible")
