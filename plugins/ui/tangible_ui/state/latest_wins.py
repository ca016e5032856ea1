"""Asks that come faster than they are answered: what began is finished, and of those that wait the newest alone is."""

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import TypeVar, final

T = TypeVar("T")


@final
class Newest:
    """One at a time. Nothing queues up."""

    def __init__(self, pause_s: float = 0.0) -> None:
        """pause_s: after each, for others; the first one after a longer rest begins at once."""
        self._lock = asyncio.Lock()
        self._newest = 0
        self._pause_s, self._rested_s = pause_s, 0.0

    async def do(self, work: Callable[[], Awaitable[T]]) -> T | None:
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
