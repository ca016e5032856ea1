"""Scheduling of jobs: long ones are numbered and give way to newer ones; of frequent ones the latest wins."""

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import TypeVar, final


@final
class LongJobs:
    """Long jobs are numbered: a newer one takes the place of those before it."""

    def __init__(self) -> None:
        self.newest = 0
        self.running: set[int] = set()
        """Numbers of those that somebody waits for."""
        self.apply_after = False
        """Whether to look, after the one at work, if what was edited meanwhile can be applied at once."""
        self.killed = False
        """Whether the worker was killed for an earlier one: if the newest met the one that died, it is asked again."""

    def begin(self) -> int:
        """The number of another one."""
        self.newest += 1
        self.running.add(self.newest)
        return self.newest

    def stop(self) -> None:
        """None of those at work is wanted any more."""
        self.newest += 1
        self.killed, self.apply_after = True, False


T = TypeVar("T")


@final
class LatestWins:
    """One at a time. Nothing queues up."""

    def __init__(self, pause_s: float = 0.0) -> None:
        """pause_s: after each, for others; the first one after a longer rest begins at once."""
        self._lock = asyncio.Lock()
        self._newest = 0
        self._pause_s, self._rested_s = pause_s, 0.0

    async def run(self, work: Callable[[], Awaitable[T]]) -> T | None:
        """Do it, once what is done now is done; None if a newer one was asked for before that."""
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
