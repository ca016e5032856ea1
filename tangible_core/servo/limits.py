"""The time limits of a force loop: how long each of its partners may be silent before there is no force.

The table of docs/explanation/safety.md is made of these constants and their docstrings, in this order.
"""

# Stale sample: age of the newest position at which the force is cut to zero; the default of `safety.stale_s`.
STALE_SAMPLE_S = 0.02
WATCHDOG_S = 0.2
"""Watchdog time-out: time without a tick after which the host kills the loop's process and opens the device once more
to release it; the default of `safety.watchdog_s`."""
# Least watchdog time-out: the loop's own watchdog needs `WATCHDOG_POLLS` polls within its share of it.
MIN_WATCHDOG_S = 0.12
# Greatest watchdog time-out: the longest time for which a loop that stands still may hold a force.
MAX_WATCHDOG_S = 0.5
WATCHDOG_PERIODS = 4  # watchdog time-out of a slow loop in periods, where that is longer
WATCHDOG_OWN_SHARE = 0.7
"""Share of the watchdog time-out after which the loop's own process gives up, which needs no new process to release the
device. The host's is for a force law that holds Python's lock, a driver that does not return, and a suspended process.
"""
WATCHDOG_POLL_S = 0.02  # watchdog poll: interval at which both watchdogs look for new ticks
# Least number of polls without a tick: where the watching process stood still itself, the loop may be well.
WATCHDOG_POLLS = 4
# Longest time until the first tick; compiling everything takes a tenth of it.
FIRST_TICK_S = 300.0
ABANDON_S = 0.5
"""Time after which the loop's process abandons a loop that was stopped and still runs: it is stuck in its force law or
its device."""
# Time after which the host kills the process of a loop that was stopped and has not ended.
KILL_S = 3.0
POINTER_SILENCE_S = 0.1
"""Silence of a pointer's client after which its position is stale; the default of the device's `stale_after_s`."""
POINTER_DEVICE_SILENCE_S = 0.5
"""Silence of a pointer device after which its client reads no force."""
PAGE_SILENCE_S = 0.1
"""Silence of a page after which its hand is released."""
PAGE_SERVER_SILENCE_S = 0.3
"""Silence of the page's server after which the loop releases the page's hand: a machine that starts a browser keeps the
server waiting for a quarter of a second."""
PAGE_FOLLOW_S = 0.012
"""Time constant with which the loop follows the page's hand: mice move 60 times a second, the loop ticks 1000 times."""
