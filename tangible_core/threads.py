"""Threads for kernels that release the GIL, and a word to the user while those kernels are compiled.

No OpenMP: its idle threads spin and take the processor from whoever works.
"""

import logging
import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from typing import Any

from numba.core import event

log = logging.getLogger(__name__)


def thread_count() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run_all(jobs: Iterable[Callable[[], Any]]) -> None:
    """Run every job and wait; the calling thread does the first. A job must not call `run_all` itself."""
    first, *rest = jobs
    waiting = [_pool(os.getpid()).submit(each) for each in rest]
    try:
        first()
    finally:
        for each in waiting:
            each.result()


def in_blocks(length: int, work: Callable[[int, int], Any], at_least: int = 16) -> None:
    """work(start, stop) on about equal parts of range(length), one a thread, none much shorter than `at_least`."""
    parts = max(1, min(thread_count(), length // at_least))
    edges = [i * length // parts for i in range(parts + 1)]
    run_all([lambda a=a, b=b: work(a, b) for a, b in pairwise(edges)])


def in_turns(tasks: list[Any], work: Callable[[list[Any]], Any]) -> None:
    """work(share) on interleaved shares of the tasks, one share a thread."""
    parts = min(thread_count(), len(tasks))
    if parts:
        run_all([lambda t=t: work(tasks[t::parts]) for t in range(parts)])


@cache
def _pool(process: int) -> ThreadPoolExecutor:
    """A pool a process: threads do not survive a fork."""
    return ThreadPoolExecutor(thread_count(), thread_name_prefix="tangible")


class _CompileNotice(event.Listener):
    """Says once a process and family of plugins that kernels are being compiled."""

    def __init__(self) -> None:
        self.said: set[str] = set()

    def on_start(self, event: Any) -> None:
        package = event.data["dispatcher"].py_func.__module__.partition(".")[0]
        if package.startswith("tangible_") and package not in self.said:
            self.said.add(package)
            kind = package.removeprefix("tangible_")
            log.warning("compiling the %s kernels for this processor; the next process finds them on disk", kind)

    def on_end(self, event: Any) -> None:
        pass


event.register("numba:compile", _CompileNotice())  # pyright: ignore[reportUnknownMemberType]
