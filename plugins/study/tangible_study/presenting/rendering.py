"""A test of whether a device rendered what was requested, by the ticks of a trial."""

from dataclasses import dataclass, field

import numpy as np

from tangible_core.data import TICK_COLUMNS, UNTOUCHED, TickFlag

from ..design import Limits

TIME, LATE, FLAGS = (TICK_COLUMNS.index(each) for each in ("time_s", "late_s", "flags"))
LIMITED = {
    TickFlag.FORCE_LIMITED: "the force was limited to the greatest that is allowed",
    TickFlag.STIFFNESS_LIMITED: "the force law was softened, as it is too stiff for this device",
    TickFlag.SLEW_LIMITED: "the force was delayed, as it changed too quickly",
    TickFlag.DAMPED: "the hand was damped, as the force gave it energy",
    TickFlag.NOT_FINITE: "the force was zero, as it was not a number",
    TickFlag.STALE: "the force was zero, as the device gave no position in time",
}
"""Sentences about the guard's changes of a force; a force that fades in is as requested."""


@dataclass
class Rendering:
    """Counts of the ticks of a trial."""

    ticks: int = 0
    touching: int = 0
    overruns: int = 0
    flagged: dict[TickFlag, int] = field(default_factory=dict[TickFlag, int])
    late_s: list[float] = field(default_factory=list[float])
    """The 99th percentile and the maximum of each part of the ticks."""
    last_s: float = 0.0
    """Time of the last tick."""

    def add(self, rows: np.ndarray) -> None:
        """Count more ticks, rows of `TICK_COLUMNS`."""
        if not len(rows):
            return
        flags = rows[:, FLAGS].astype(np.int64)
        self.ticks, self.last_s = self.ticks + len(rows), float(rows[-1, TIME])
        self.touching += int(np.count_nonzero(flags & (TickFlag.TOUCHING | TickFlag.NOT_FINITE | TickFlag.STALE)))
        self.overruns += int(np.count_nonzero(flags & TickFlag.OVERRUN))
        for flag in LIMITED:
            self.flagged[flag] = self.flagged.get(flag, 0) + int(np.count_nonzero(flags & flag))
        self.late_s += [float(np.percentile(rows[:, LATE], 99)), float(rows[:, LATE].max())]

    def why_not(self, limits: Limits) -> str | None:
        """Return why the device did not render what was requested; None if it did."""
        flag, count = max(self.flagged.items(), key=lambda each: each[1], default=(None, 0))
        if flag is not None and self.touching and count > limits.limited * self.touching:
            return f"{LIMITED[flag]}, in {100 * count / self.touching:.0f} % of the time in contact"
        if self.ticks and self.overruns > limits.late * self.ticks:
            return f"{100 * self.overruns / self.ticks:.0f} % of the ticks came too late"
        return None


assert not any(flag & UNTOUCHED for flag in LIMITED)
