"""The watchdog of a force loop: it notices that ticks stop coming, in the loop's process and in its host."""

from time import monotonic
from typing import final

import numpy as np

from .ring import COUNT, LAST, STOP

POLL_S = 0.02
"""Interval at which a watchdog looks for new ticks."""
TIMEOUT_S = 0.2
"""Time without a tick after which the host kills the loop's process."""
TIMEOUT_PERIODS = 4
"""The same in periods of the loop, for a slow one."""
OWN_SHARE = 0.7
"""Share of the time-out after which the loop's own process gives up, which needs no new process to release the device.

The host's time-out is for a force law that holds Python's lock, a driver that does not return, and a suspended process.
"""
MIN_POLLS = 4
"""Least number of polls without a tick: where the watching process stood still itself, the loop may be well."""
STOOD_STILL = "the force loop stood still: its force law or its device did not answer, or its process was stopped"


@final
class Watchdog:
    """A watch over the ticks of one loop, for a thread that polls it every `POLL_S`."""

    def __init__(self, header: np.ndarray, timeout_s: float, stopping_s: float) -> None:
        """Start to watch. timeout_s: the longest time without a tick; stopping_s: that of a loop that is to end."""
        self._header, self._timeout_s, self._stopping_s = header, timeout_s, stopping_s
        self._count, self._since_s, self._polls = -1, 0.0, 0

    def expired(self) -> bool:
        """Look for a new tick, and return whether there was none for too long."""
        self._polls += 1
        if self._header[COUNT] != self._count:
            self._count, self._since_s, self._polls = int(self._header[COUNT]), monotonic(), 0
        ending = self._header[STOP] or self._count >= self._header[LAST]
        limit_s = self._stopping_s if ending else self._timeout_s
        return self._polls >= MIN_POLLS and monotonic() - self._since_s >= limit_s


def timeout_s(period_s: float) -> float:
    """Return the longest time without a tick for a loop of this period."""
    return max(TIMEOUT_S, TIMEOUT_PERIODS * period_s)
