"""The drain of a ring: passes each tick of a running force loop on once, such as to a recording."""

import logging
from collections.abc import Callable
from typing import final

import numpy as np

from ..servo import Servo

log = logging.getLogger(__name__)


@final
class RingDrain:
    """A drain that passes each tick of a loop to `keep` once, in tables of `data.TICK_COLUMNS`, as for a `Writer`.

    The owner of the loop calls `look` at least every few seconds, as a ring holds eight seconds, and once more after
    the loop has ended. Swapped scenes make no difference. Use it for one loop and from one thread at a time, preferably
    a thread that Ctrl-C cannot interrupt, as otherwise it is unknown which ticks were passed on.
    """

    def __init__(self, servo: Servo, keep: Callable[[np.ndarray], None], first: int = 0) -> None:
        """Begin with the tick of number `first`, such as `servo.ring.count` for all ticks from now on."""
        self._servo, self._keep = servo, keep
        self._next = first

    def look(self) -> None:
        """Pass on the ticks since the last call; logs how many were overwritten before, and so are lost.

        Raises: whatever `keep` raises, such as OutputError on a full disk; the loop goes on, and the next call passes
        these ticks on again.
        """
        rows, following = self._servo.ring.since(self._next)
        if lost := following - self._next - len(rows):
            log.warning("%d ticks were overwritten before they could be recorded; the machine is too busy", lost)
        if len(rows):
            self._keep(rows)
        self._next = following
