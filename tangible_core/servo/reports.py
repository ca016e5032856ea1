"""Reports of a force loop, made of its ring."""

import math
from bisect import bisect_left
from collections import Counter
from dataclasses import replace
from itertools import accumulate
from typing import NamedTuple, Self

import numpy as np
from jaxtyping import Float64, Int64

from ..data import TICK_COLUMNS, Force, HapticState, ServoReport, Spread, TickFlag, Vector, beacon_part
from .beacon import TICKS
from .guard import safety
from .ring import LONGEST_S, MAX_LATE_S, PEAK_N, WORK_J, Ring

AT = {name: column for column, name in enumerate(TICK_COLUMNS)}
# The row of a loop before its first tick.
NOTHING_YET = np.array([np.nan if name == "frame" else 0.0 for name in TICK_COLUMNS])
# Totals of several loops that are the greatest of theirs; the others are sums.
GREATEST = ("peak_force_n", "most_late_s", "longest_s")
Counts = Int64[np.ndarray, "n"]  # a histogram of a ring


class LoopTotals(NamedTuple):
    """The counts, sums and histograms of a loop, or of several consecutive loops of one session."""

    ticks: int
    overruns: int
    peak_force_n: float
    work_j: float
    most_late_s: float
    longest_s: float
    late: Counts
    period: Counts
    contact: Counts
    flagged: Counter[str]

    @classmethod
    def of(cls, ring: Ring) -> Self:
        """Return the totals so far of the loop that writes to this ring."""
        return cls(
            ticks=ring.count,
            overruns=ring.overruns,
            peak_force_n=float(ring.sums[PEAK_N]),
            work_j=float(ring.sums[WORK_J]),
            most_late_s=float(ring.sums[MAX_LATE_S]),
            longest_s=float(ring.sums[LONGEST_S]),
            late=ring.late.copy(),
            period=ring.period.copy(),
            contact=ring.contact.copy(),
            flagged=_flag_counts(ring),
        )

    def plus(self, later: Self) -> Self:
        """Return the totals of both."""
        sums = {name: getattr(self, name) + getattr(later, name) for name in self._fields}
        greatest = {name: max(getattr(self, name), getattr(later, name)) for name in GREATEST}
        return self._replace(**sums | greatest)


def report(ring: Ring, stopped: str = "", before: LoopTotals | None = None, since_s: float = 0.0) -> ServoReport:
    """Return a report of the loop that writes to this ring; before: totals of the loops before it in the session."""
    rows, _ = ring.since(ring.count - 1)
    rows[:, AT["time_s"]] += since_s
    totals = LoopTotals.of(ring)
    totals = totals if before is None else before.plus(totals)
    touching = int(totals.contact.sum())
    return replace(
        brief_report(rows, totals.ticks, totals.peak_force_n, totals.work_j, stopped),
        period_us=spread(totals.period, totals.longest_s),
        late_us=spread(totals.late, totals.most_late_s),
        overruns=totals.overruns,
        flagged=dict(totals.flagged),
        contact_share=min(1.0, touching / max(1, totals.ticks)),
        median_contact_force_n=_median_n(totals.contact, touching),
    )


def _flag_counts(ring: Ring) -> Counter[str]:
    """Count the ticks with each flag of the guard, and with a beacon."""
    flags = safety.counts(ring.guard)
    if ticks := int(ring.beacon.words[TICKS]):
        flags[TickFlag.BEACON] = ticks
    return Counter({flag.name or "": count for flag, count in flags.items()})


def _median_n(contact: Counts, touching: int) -> float:
    """Return the median force: the middle of the bin, 1 mN wide, that half of the ticks are in or under."""
    return (int(np.searchsorted(np.cumsum(contact), touching / 2)) + 0.5) / 1000 if touching else 0.0


def brief_report(
    rows: Float64[np.ndarray, "n columns"], ticks: int, peak_force_n: float, work_j: float, stopped: str
) -> ServoReport:
    """Return a report without the loop's timing; the last of these rows is the last of the ticks."""
    last = rows[-1] if len(rows) else NOTHING_YET
    time_s, buttons = float(last[AT["time_s"]]), int(last[AT["buttons"]])
    return ServoReport(
        ticks=ticks,
        time_s=time_s,
        state=HapticState(_three(last, "x_m"), _three(last, "vx_m_per_s"), time_s, buttons),
        force=Force(*_three(last, "fx_n")),
        peak_force_n=peak_force_n,
        work_j=work_j,
        stopped=stopped,
        beacon=beacon_part(int(last[AT["flags"]])),
        frame=None if math.isnan(last[AT["frame"]]) else int(last[AT["frame"]]),
    )


def spread(counts: np.ndarray, most_s: float) -> Spread:
    """Return the quantiles of a histogram of microseconds: the smallest bin that holds, with those below, the share.

    >>> spread(np.array([0, 90, 9, 1]), 3e-6)
    Spread(p50=1.0, p99=2.0, p999=3.0, most=3.0)
    """
    ticks: list[int] = counts.tolist()
    below = list(accumulate(ticks))
    p50, p99, p999 = (float(bisect_left(below, math.ceil(share * below[-1]))) for share in (0.5, 0.99, 0.999))
    return Spread(p50, p99, p999, 1e6 * most_s)


def _three(row: np.ndarray, first: str) -> Vector:
    x, y, z = row[AT[first] : AT[first] + 3].tolist()
    return x, y, z
