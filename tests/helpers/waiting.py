"""Waiting until something has happened, on a machine that may stand still meanwhile."""

import asyncio
import time
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")

LONGEST_S = 180.0
"""Seconds after which an event counts as missing; only a fault waits that long."""
LONGEST_MS = 1000 * LONGEST_S
"""The same for the browser."""
PAUSE_S, LONGEST_PAUSE_S, LATER = 0.01, 0.05, 0.1
"""Seconds between two looks at first, at most, and as a share of those waited: a look at a page takes milliseconds."""


def until(condition: Callable[[], T], what: str = "it did not happen") -> T:
    """Return what `condition` gives, as soon as that is true. Raises: AssertionError after `LONGEST_S`."""
    begun_s = time.monotonic()
    while not (found := condition()):
        time.sleep(_pause_s(begun_s, what))
    return found


async def happened(condition: Callable[[], T], what: str = "it did not happen") -> T:
    """Return what `condition` gives, as soon as that is true; the event loop goes on. Raises: as `until`."""
    begun_s = time.monotonic()
    while not (found := condition()):
        await asyncio.sleep(_pause_s(begun_s, what))
    return found


def _pause_s(begun_s: float, what: str) -> float:
    waited_s = time.monotonic() - begun_s
    assert waited_s < LONGEST_S, what
    return min(LONGEST_PAUSE_S, PAUSE_S + LATER * waited_s)
