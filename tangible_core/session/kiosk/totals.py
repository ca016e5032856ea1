"""The loops of a session as one: its clock, its sums, and the ticks of its recording."""

from collections.abc import Callable
from typing import final

import numpy as np

from ...data import ServoReport, TickFlag
from ...runtime.system.timers import now_ns
from ...servo import Servo
from ...servo.reports import LoopTotals, report
from ..recording.tick_arrays import ARRAYS

PERIOD_S = 0.001
"""Period of a loop, after which the last tick of a lost device is recorded."""


@final
class SessionTotals:
    """The totals of all loops of a session, and the time since its first tick."""

    def __init__(self, keep: Callable[[np.ndarray], None]) -> None:
        """keep: called with all ticks, their times those of the session."""
        self._keep = keep
        self._first_ns = 0
        """Time at which the first tick of the session was due; 0 before it."""
        self.since_s: float = 0.0
        """Time from then to the first tick of the current loop."""
        self._before: LoopTotals | None = None
        self._row: np.ndarray | None = None

    @property
    def begun(self) -> bool:
        """True once a loop has begun."""
        return self._first_ns > 0

    @property
    def passed_s(self) -> float:
        """Time since the first tick, with or without a device; 0 before it."""
        return (now_ns() - self._first_ns) / 1e9 if self.begun else 0.0

    def begin(self, began_ns: int) -> None:
        """Begin a loop, whose first tick was due at this time."""
        self._first_ns = self._first_ns or began_ns
        self.since_s = (began_ns - self._first_ns) / 1e9

    def report(self, servo: Servo, stopped: str) -> ServoReport:
        """Return the report of the session so far."""
        return report(servo.ring, stopped, self._before, self.since_s)

    def keep(self, rows: np.ndarray) -> None:
        """Pass on ticks of the current loop."""
        rows[:, ARRAYS["time_s"]] += self.since_s
        self._row = rows[-1].copy()
        self._keep(rows)

    def close(self, servo: Servo) -> None:
        """Add the totals of a lost loop to the session, and record a tick without force."""
        totals = LoopTotals.of(servo.ring)
        self._before = totals if self._before is None else self._before.plus(totals)
        if self._row is not None:
            self._row[ARRAYS["time_s"]] += PERIOD_S
            self._row[ARRAYS["force_n"]], self._row[ARRAYS["flags"]] = 0.0, float(TickFlag.STALE)
            self._keep(self._row[None])
            self._row = None
