"""When the next tick is due, and how long before it a loop should wake: the same for compiled loops and Python's."""

import numpy as np

from .ring import COUNT, LAST, LEAD_NS, NEXT_NS, OVERRUNS, PERIOD_NS, SPINS, STOP, SWAP

MOST_LEAD_NS = 150_000
"""A loop waits awake for no longer than this; 15 % of a period of 1 ms."""


def going(header: np.ndarray) -> bool:
    """Whether the scene that is felt now has another tick to come."""
    return header[STOP] == 0 and header[SWAP] == 0 and header[COUNT] < header[LAST]


def begin_tick(header: np.ndarray, at_ns: int) -> int:
    """Begin the tick that was due: count what was missed, and set when the next is due. Returns nanoseconds late.

    Periods that went by without a tick are counted and not made up for: the next tick is due in step with the first.

    The lead grows by much after a late tick, and shrinks by a thousandth of that after one that was not. So about one
    tick in a thousand is late: the lead follows that quantile of the time that waking takes.
    """
    late_ns = at_ns - header[NEXT_NS]
    if header[SPINS] != 0:
        lead_ns = header[LEAD_NS]
        header[LEAD_NS] = min(lead_ns + 10_000, MOST_LEAD_NS) if late_ns > 1_000 else max(lead_ns - 10, 0)
    missed = late_ns // header[PERIOD_NS]
    header[OVERRUNS] += missed
    header[NEXT_NS] += (missed + 1) * header[PERIOD_NS]
    return late_ns
