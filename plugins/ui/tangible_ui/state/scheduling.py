"""Scheduling of jobs: long ones are numbered and give way to newer ones; of frequent ones the latest wins."""

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import TypeVar, final


@final
class LongJobs:
    """Numbers of long jobs: a newer one replaces those before it."""

    def __init__(self) -> None:
        self.newest: int = 0
        self.running: set[int] = set()
        """Numbers of the jobs that somebody waits for."""
        self.apply_after: bool = False
        """True if edits came during the running job: when it ends, apply them unless something slow has to run."""
        self.killed: bool = False
        """True if the worker was killed for an earlier job: if the newest job died with it, it is requested again."""

    def begin(self) -> int:
        """Return the number of a new job."""
        self.newest += 1
        self.running.add(self.newest)
        return self.newest

    def stop(self) -> None:
        """Mark all running jobs as unwanted."""
        self.newest += 1
        self.killed, self.apply_after = True, False


T = TypeVar("T")


@final
class LatestWins:
    """A queue of one: the running call is finished, and of those that wait the newest alone is run."""

    def __init__(self, pause_s: float = 0.0) -> None:
        """pause_s: after each call, for others; the first call after a longer rest starts at once."""
        self._lock = asyncio.Lock()
        self._newest = 0
        self._pause_s, self._rested_s = pause_s, 0.0

    async def run(self, work: Callable[[], Awaitable[T]]) -> T | None:
        """Run the call once the running one has ended; None if a newer call came before that."""
        self._newest += 1
        mine = self._newest
        async with self._lock:
            if mine == self._newest and (early_s := self._rested_s - time.monotonic()) > 0:
                await asyncio.sleep(early_s)
            if mine != self._newest:
                return None
            try:
                return await work()
            finally:
                self._rested_s = time.monotonic() + self._pause_s
