"""How long before a tick a loop should wake."""

MOST_LEAD_NS = 150_000
"""A loop waits awake for no longer than this; 15 % of a period of 1 ms."""


def longer_lead_ns(lead_ns: int, late_ns: int) -> int:
    """The lead after a tick that was so late: longer by much if it was, else shorter by a thousandth of that.

    So about one tick in a thousand is late: the lead follows that quantile of the time that waking takes.
    """
    return min(lead_ns + 10_000, MOST_LEAD_NS) if late_ns > 1_000 else max(lead_ns - 10, 0)
