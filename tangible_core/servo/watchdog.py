"""The watchdog of a force loop: it notices that ticks stop coming, in the loop's process and in its host."""

from time import monotonic
from typing import final

import numpy as np

from . import limits
from .ring import COUNT, LAST, STOP

STOOD_STILL = "the force loop stood still: its force law or its device did not answer, or its process was stopped"


@final
class Watchdog:
    """A watch over the ticks of one loop, for a thread that polls it every `limits.WATCHDOG_POLL_S`."""

    def __init__(self, header: np.ndarray, stopping_s: float) -> None:
        """Start to watch. stopping_s: the longest time without a tick for a loop that is to end."""
        self._header, self._stopping_s = header, stopping_s
        self._count, self._since_s, self._polls = -1, 0.0, 0

    def expired(self, timeout_s: float) -> bool:
        """Look for a new tick, and return whether there was none for timeout_s."""
        self._polls += 1
        if self._header[COUNT] != self._count:
            self._count, self._since_s, self._polls = int(self._header[COUNT]), monotonic(), 0
        ending = self._header[STOP] or self._count >= self._header[LAST]
        limit_s = self._stopping_s if ending else timeout_s
        return self._polls >= limits.WATCHDOG_POLLS and monotonic() - self._since_s >= limit_s


def timeout_s(watchdog_s: float, period_s: float) -> float:
    """Return the longest time without a tick for a loop of this period. watchdog_s: `Safety.watchdog_s`."""
    return max(watchdog_s, limits.WATCHDOG_PERIODS * period_s)
