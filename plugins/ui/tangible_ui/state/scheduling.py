"""Scheduling of jobs: long ones are numbered and give way to newer ones; of frequent ones the latest wins."""

import asyncio
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
        self._pause_s = pause_s
        self._busy = False
        self._turn: asyncio.Future[bool] | None = None
        """Resolved for the call that waits: True once it may run, False once a newer call came."""

    async def run(self, work: Callable[[], Awaitable[T]]) -> T | None:
        """Run the call once the running one has ended; None as soon as a newer call comes before that."""
        self._resolve(False)
        loop = asyncio.get_running_loop()
        if self._busy:
            self._turn = turn = loop.create_future()
            if not await turn:
                return None
        self._busy = True
        try:
            return await work()
        finally:
            loop.call_later(self._pause_s, self._end)

    def _end(self) -> None:
        self._busy = self._resolve(True)

    def _resolve(self, is_next: bool) -> bool:
        """Tell the call that waits; return True if there is one."""
        turn, self._turn = self._turn, None
        if turn is None or turn.done():
            return False
        turn.set_result(is_next)
        return True
