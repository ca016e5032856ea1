"""What a ring says of its loop."""

import math
from bisect import bisect_left
from dataclasses import replace
from itertools import accumulate

import numpy as np
from jaxtyping import Float64

from ..data import TICK_COLUMNS, Force, HapticState, ServoReport, Spread, Vector
from .guard import safety
from .ring import COUNT, LONGEST_S, MOST_LATE_S, OVERRUNS, PEAK_N, WORK_J, Ring

AT = {name: column for column, name in enumerate(TICK_COLUMNS)}


def report(ring: Ring, stopped: str = "") -> ServoReport:
    """How the loop that writes to this ring is doing."""
    rows, count = ring.since(int(ring.header[COUNT]) - 1)
    return replace(
        so_far(rows, count, float(ring.sums[PEAK_N]), float(ring.sums[WORK_J]), stopped),
        period_us=spread(ring.period, float(ring.sums[LONGEST_S])),
        late_us=spread(ring.late, float(ring.sums[MOST_LATE_S])),
        overruns=int(ring.header[OVERRUNS]),
        flagged={flag.name or "": count for flag, count in safety.counts(ring.guard).items()},
    )


def so_far(
    rows: Float64[np.ndarray, "n columns"], ticks: int, peak_force_n: float, work_j: float, stopped: str
) -> ServoReport:
    """After so many ticks, the last of which is the last of these rows; of the loop's time nothing is said."""
    last = rows[-1] if len(rows) else np.zeros(len(TICK_COLUMNS))
    time_s, buttons = float(last[AT["time_s"]]), int(last[AT["buttons"]])
    return ServoReport(
        ticks=ticks,
        time_s=time_s,
        state=HapticState(_three(last, "x_m"), _three(last, "vx_m_per_s"), time_s, buttons),
        force=Force(*_three(last, "fx_n")),
        peak_force_n=peak_force_n,
        work_j=work_j,
        stopped=stopped,
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
