"""Threads for kernels that release the GIL.

Without OpenMP, whose idle threads spin and take the processor from working ones.
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
from ..runtime.system.processes import processors
from ..runtime.threads import thread_limit
from . import compiling as compiling  # for its notice while kernels are compiled

T = TypeVar("T")


def thread_count() -> int:
    """Return the number of working threads: one for each processor, within the limit of `runtime.threads`."""
    return min(processors(), thread_limit() or processors())


def run_all(jobs: Iterable[Callable[[], Any]]) -> None:
    """Run every job and wait; the calling thread does the first. A job must not call `run_all` itself.

    Pass at most `thread_count` jobs: each gets a thread.
    Raises: Stopped before any job if the caller's work shall end; a job can check that as well. An error of the calling
    thread, such as an interrupt, takes precedence over errors that it causes in other threads.
    """
    check_stopped()
    first, *rest = jobs
    waiting = [_pool(os.getpid()).submit(copy_context().run, job) for job in rest]
    try:
        first()
    finally:
        wait(waiting)
    for job in waiting:
        job.result()


def in_blocks(length: int, work: Callable[[int, int], Any], at_least: int = 16) -> None:
    """Run work(start, stop) on nearly equal parts of range(length), one a thread, of about `at_least` or more."""
    parts = max(1, min(thread_count(), length // at_least))
    edges = [i * length // parts for i in range(parts + 1)]
    run_all([lambda a=a, b=b: work(a, b) for a, b in pairwise(edges)])


def in_turns(tasks: list[T], work: Callable[[Iterable[T]], Any], most: int | None = None) -> None:
    """Run work(share) in up to `most` threads; each share takes the next task in order whenever it has finished one."""
    parts = min(thread_count(), len(tasks), len(tasks) if most is None else most)
    if parts:
        remaining = deque(tasks)
        run_all([lambda: work(_take(remaining)) for _ in range(parts)])


def _take(remaining: deque[T]) -> Iterator[T]:
    """Yield tasks until none is left; another thread may take the last one between the check and the removal."""
    with suppress(IndexError):
        while remaining:
            check_stopped()
            yield remaining.popleft()


@cache
def _pool(process: int) -> ThreadPoolExecutor:
    """Return the pool of a process: threads do not survive a fork."""
    return ThreadPoolExecutor(processors(), thread_name_prefix="tangible")
