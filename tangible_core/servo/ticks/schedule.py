"""The schedule of ticks: when the next one is due, and how long before a loop wakes, in compiled code and Python."""

import numpy as np

from ..ring import COUNT, LAST, LEAD_NS, NEXT_NS, OVERRUNS, PERIOD_NS, SPINS, STOP, SWAP

# Longest time for which a loop spins before a tick: 15 % of a period of 1 ms.
MAX_LEAD_NS = 150_000


def going(header: np.ndarray) -> bool:
    """Return True if the current scene has another tick."""
    return header[STOP] == 0 and header[SWAP] == 0 and header[COUNT] < header[LAST]


def begin_tick(header: np.ndarray, at_ns: int) -> int:
    """Begin the tick that was due, count missed periods, and schedule the next one; return how late it is, nanoseconds.

    Missed periods are not made up for: the next tick is due in step with the first.

    After a late tick the lead grows; after a punctual one it shrinks by a thousandth of that. So about one tick in a
    thousand is late: the lead follows that quantile of the time that waking takes.
    """
    late_ns = at_ns - header[NEXT_NS]
    if header[SPINS] != 0:
        lead_ns = header[LEAD_NS]
        header[LEAD_NS] = min(lead_ns + 10_000, MAX_LEAD_NS) if late_ns > 1_000 else max(lead_ns - 10, 0)
    misses = late_ns // header[PERIOD_NS]
    header[OVERRUNS] += misses
    header[NEXT_NS] += (misses + 1) * header[PERIOD_NS]
    return late_ns
