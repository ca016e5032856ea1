"""Asks that come faster than they are answered: what began is finished, and of those that wait the newest alone is."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import TypeVar, final

T = TypeVar("T")


@final
class Newest:
    """One at a time. Nothing queues up."""

    def __init__(self) -> None:
        self._lock = asyncio.Lock()
        self._newest = 0

    async def do(self, work: Callable[[], Awaitable[T]]) -> T | None:
        """Do it, once what is done now is done; None if a newer one was asked for before that."""
        self._newest += 1
        mine = self._newest
        async with self._lock:
            return await work() if mine == self._newest else None
