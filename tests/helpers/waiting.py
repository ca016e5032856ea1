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
PAUSE_S = 0.01
"""Seconds between two looks."""


def until(condition: Callable[[], T], what: str = "it did not happen") -> T:
    """Return what `condition` gives, as soon as that is true. Raises: AssertionError after `LONGEST_S`."""
    end_s = time.monotonic() + LONGEST_S
    while not (found := condition()):
        assert time.monotonic() < end_s, what
        time.sleep(PAUSE_S)
    return found


async def happened(condition: Callable[[], T], what: str = "it did not happen") -> T:
    """Return what `condition` gives, as soon as that is true; the event loop goes on. Raises: as `until`."""
    end_s = time.monotonic() + LONGEST_S
    while not (found := condition()):
        assert time.monotonic() < end_s, what
        await asyncio.sleep(PAUSE_S)
    return found
