"""The ticks of a force loop that runs, each handed on once: what a recording is made of."""

import logging
from collections.abc import Callable
from typing import final

import numpy as np

from ..servo import Servo

log = logging.getLogger(__name__)


@final
class Keeper:
    """Hands each tick of a loop to `keep`, once, in tables of `data.TICK_COLUMNS`, as a `Writer` appends them.

    Whoever owns the loop looks now and then: at least every few seconds, as a ring holds eight of them, and once more
    when the loop has ended. Other scenes that are felt on the same loop change nothing. For one loop and one thread at
    a time: better one where no Ctrl-C ends a look half done, as nobody would know which ticks are kept.
    """

    def __init__(self, servo: Servo, keep: Callable[[np.ndarray], None], first: int = 0) -> None:
        """first: number of the tick to begin with, such as `servo.ring.count` for those from now on."""
        self._servo, self._keep = servo, keep
        self._next = first

    def look(self) -> None:
        """Hand on what came since the last look. The log says how many ticks came too long ago, and are lost.

        Raises: whatever `keep` does, as OutputError on a full disk; the loop goes on, and these ticks are handed on
        again by the next look.
        """
        rows, following = self._servo.ring.since(self._next)
        if lost := following - self._next - len(rows):
            log.warning("%d ticks were overwritten before they could be recorded; the machine is too busy", lost)
        if len(rows):
            self._keep(rows)
        self._next = following
