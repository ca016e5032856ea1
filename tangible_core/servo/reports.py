"""What a ring says of its loop."""

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
from .ring import LONGEST_S, MOST_LATE_S, PEAK_N, WORK_J, Ring

AT = {name: column for column, name in enumerate(TICK_COLUMNS)}
NOTHING_YET = np.array([np.nan if name == "frame" else 0.0 for name in TICK_COLUMNS])
Counts = Int64[np.ndarray, "n"]
"""A histogram of a ring."""


class Counted(NamedTuple):
    """What a loop has counted, or several that followed each other in one session."""

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
        """By the loop that writes to this ring, until now."""
        return cls(
            ticks=ring.count,
            overruns=ring.overruns,
            peak_force_n=float(ring.sums[PEAK_N]),
            work_j=float(ring.sums[WORK_J]),
            most_late_s=float(ring.sums[MOST_LATE_S]),
            longest_s=float(ring.sums[LONGEST_S]),
            late=ring.late.copy(),
            period=ring.period.copy(),
            contact=ring.contact.copy(),
            flagged=_flagged(ring),
        )

    def then(self, later: Self) -> Self:
        """Both."""
        return self._replace(
            ticks=self.ticks + later.ticks,
            overruns=self.overruns + later.overruns,
            peak_force_n=max(self.peak_force_n, later.peak_force_n),
            work_j=self.work_j + later.work_j,
            most_late_s=max(self.most_late_s, later.most_late_s),
            longest_s=max(self.longest_s, later.longest_s),
            late=self.late + later.late,
            period=self.period + later.period,
            contact=self.contact + later.contact,
            flagged=self.flagged + later.flagged,
        )


def report(ring: Ring, stopped: str = "", before: Counted | None = None, since_s: float = 0.0) -> ServoReport:
    """How the loop that writes to this ring is doing.

    before: what loops before it counted in the same session, which began since_s before this one's clock.
    """
    rows, _ = ring.since(ring.count - 1)
    rows[:, AT["time_s"]] += since_s
    counted = Counted.of(ring)
    found = counted if before is None else before.then(counted)
    touching = int(found.contact.sum())
    return replace(
        so_far(rows, found.ticks, found.peak_force_n, found.work_j, stopped),
        period_us=spread(found.period, found.longest_s),
        late_us=spread(found.late, found.most_late_s),
        overruns=found.overruns,
        flagged=dict(found.flagged),
        contact_share=min(1.0, touching / max(1, found.ticks)),
        median_contact_force_n=_median_n(found.contact, touching),
    )


def _flagged(ring: Ring) -> Counter[str]:
    """Ticks by the flags of the guard, and by that of a beacon."""
    flags = safety.counts(ring.guard)
    if pulled := int(ring.beacon.words[TICKS]):
        flags[TickFlag.BEACON] = pulled
    return Counter({flag.name or "": count for flag, count in flags.items()})


def _median_n(contact: Counts, touching: int) -> float:
    """The middle of the millinewton that half of the ticks with a force are in or under."""
    return (int(np.searchsorted(np.cumsum(contact), touching / 2)) + 0.5) / 1000 if touching else 0.0


def so_far(
    rows: Float64[np.ndarray, "n columns"], ticks: int, peak_force_n: float, work_j: float, stopped: str
) -> ServoReport:
    """After so many ticks, the last of which is the last of these rows; of the loop's time nothing is said."""
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
    """Quantiles of a histogram of microseconds: the smallest bin that so many are in or under.

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
