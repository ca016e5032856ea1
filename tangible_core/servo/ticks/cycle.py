"""The tick of a force loop, and the loop that keeps time, compiled. Imports numba."""

# pyright: basic, reportCallIssue=false

import math
from typing import Any

from numba import int64, types
from numba.extending import intrinsic

from ...compiled.compiling import KERNEL, njit
from ...compiled.touch import FRAME
from ...compiled.touch import RISE_M as RISE
from ...data import TICK_COLUMNS, TickFlag
from ..beacon_kernels import pull
from ..guard.coupling import couple
from ..guard.guard import guard, wait
from ..guard.layout import RISE_M
from ..ring import (
    COUNT,
    LEAD_NS,
    LONGEST_S,
    MARKS,
    MAX_LATE_S,
    NEXT_NS,
    PEAK_N,
    PERIOD_NS,
    PREVIOUS_NS,
    START_NS,
    STOP,
    STRONGEST_MN,
    WIDEST_US,
    WORK_J,
)
from . import schedule
from .clock import SECOND_NS, wait_ns

FLAGS = TICK_COLUMNS.index("flags")
STATE = 7  # length of a device's state, as in `LinkKernels`
OVERRUN = int(TickFlag.OVERRUN)
begin_tick: Any = njit(**KERNEL)(schedule.begin_tick)
going: Any = njit(**KERNEL)(schedule.going)
# Indices in `now` of the generators below: when a tick began, and how late it was, nanoseconds.
AT, LATE = 0, 1
NO_MORE = -1  # value of `now[AT]` that ends a generator


@intrinsic
def _store(context, array, index, value):
    """Write a number of an int64 array with release order: a reader that sees it sees all that was written before."""

    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        at = builder.gep(data, [arguments[1]])
        builder.store_atomic(arguments[2], at, "release", 8)
        builder.fence("release")  # so that no later write is visible before it
        return context.get_dummy_value()

    return types.void(array, types.int64, types.int64), generate


@njit(**KERNEL)
def publish(header, sums, late, period, contact, stamps, ticks, row, at_ns, late_ns):
    """Write a tick's row to the ring, and add it to the sums."""
    count = header[COUNT]
    slot = count % stamps.shape[0]
    force_n = math.sqrt(row[11] * row[11] + row[12] * row[12] + row[13] * row[13])
    sums[PEAK_N] = max(sums[PEAK_N], force_n)
    if force_n > 0:
        contact[int(min(1000 * force_n, STRONGEST_MN - 1.0))] += 1
    late[min(max(late_ns, 0) // 1000, WIDEST_US - 1)] += 1
    sums[MAX_LATE_S] = max(sums[MAX_LATE_S], late_ns / SECOND_NS)
    if count > 0:
        last = ticks[(count - 1) % stamps.shape[0]]
        sums[WORK_J] += last[11] * (row[2] - last[2]) + last[12] * (row[3] - last[3]) + last[13] * (row[4] - last[4])
        since_ns = at_ns - header[PREVIOUS_NS]
        period[min(max(since_ns, 0) // 1000, WIDEST_US - 1)] += 1
        sums[LONGEST_S] = max(sums[LONGEST_S], since_ns / SECOND_NS)
    header[PREVIOUS_NS] = at_ns
    # A reader takes a row only if its stamp is the same before and after: -1 while it is written, and its count once it
    # is whole. The count of rows comes last, so that no row is announced before it is there.
    _store(stamps, slot, -1)
    for i in range(row.shape[0]):
        ticks[slot, i] = row[i]
    _store(stamps, slot, count)
    _store(header, COUNT, count + 1)


@njit(**KERNEL)
def allow_force(law, limits, period_s, x, y, z, vx, vy, vz, buttons):
    """Return the allowed part of the law's and the beacon's force for a fresh state of the device, and the flags."""
    of_law, tick, _, moving = law
    settings, memory, beacon = limits
    tool = couple(settings, memory, period_s, x, y, z, vx, vy, vz)
    force_n = tick(*of_law, *tool)
    memory[RISE_M] = moving[RISE]
    pull_flags = pull(*beacon, memory, period_s, tool[0], tool[1], tool[3], tool[4], int64(buttons))
    fx, fy, fz, flags = guard(settings, memory, period_s, x, y, z, vx, vy, vz, *force_n)
    return fx, fy, fz, flags | pull_flags


@njit(**KERNEL)
def cycle(link, law, limits, state, row, time_s, late_s, period_s):
    """Do one tick of a device and a law that are kernels, and write it to the row."""
    of_link, read, write = link
    settings, memory, _ = limits
    fresh = read(*of_link, state) != 0
    x, y, z, vx, vy, vz = state[0], state[1], state[2], state[3], state[4], state[5]
    if fresh:
        fx, fy, fz, flags = allow_force(law, limits, period_s, x, y, z, vx, vy, vz, state[6])
    else:
        fx, fy, fz, flags = wait(settings, memory, period_s)
    write(*of_link, fx, fy, fz)
    proxy, moving = law[2], law[3]
    row[0], row[1] = time_s, late_s
    row[2], row[3], row[4], row[5], row[6], row[7] = x, y, z, vx, vy, vz
    row[8], row[9], row[10] = proxy[0], proxy[1], proxy[2]
    row[11], row[12], row[13] = fx, fy, fz
    row[14], row[15], row[16] = flags, state[6], moving[FRAME]


@njit(**KERNEL)
def begin(clock, header):
    """Wait for the next tick; return when it began and how late it was, nanoseconds."""
    at_ns = wait_ns(clock, header[NEXT_NS], header[LEAD_NS])
    return at_ns, begin_tick(header, at_ns)


@njit(**KERNEL)
def finish(sections, row, at_ns, late_ns):
    """Add the loop's own flags to a tick, and write the tick to the ring and the sums."""
    header, sums, late, period, contact, stamps, ticks = sections
    flags = int(row[FLAGS]) | header[MARKS]
    header[MARKS] = 0
    row[FLAGS] = flags | (OVERRUN if late_ns >= header[PERIOD_NS] else 0)
    publish(header, sums, late, period, contact, stamps, ticks, row, at_ns, late_ns)


@njit(**KERNEL)
def step(link, law, limits, sections, state, row, at_ns, late_ns):
    """Do a whole tick that began at at_ns, late_ns late; nothing if the loop is to stop."""
    header = sections[0]
    if header[STOP] != 0:
        return
    since_ns = at_ns - header[PREVIOUS_NS] if header[COUNT] > 0 else header[PERIOD_NS]
    time_s = (at_ns - header[START_NS]) / SECOND_NS
    cycle(link, law, limits, state, row, time_s, late_ns / SECOND_NS, since_ns / SECOND_NS)
    finish(sections, row, at_ns, late_ns)


@njit(**KERNEL)
def run(clock, link, law, limits, sections, state, row):
    """Do tick after tick while the loop is `going`; Python is not needed meanwhile."""
    header = sections[0]
    while going(header):
        at_ns, late_ns = begin(clock, header)
        step(link, law, limits, sections, state, row, at_ns, late_ns)


# Python calls a generator once a tick: it keeps its arguments, as passing them takes the time of a hundred ticks. AT
# and LATE of `now` give the time of the tick; AT is NO_MORE for the last call. A generator that was started must be run
# to its end: otherwise numba keeps its arguments, a scene among them, for ever.


@njit(cache=True, error_model="numpy")
def ticks(link, law, limits, sections, state, row, now):
    """Do a whole tick at each `next`."""
    while now[AT] != NO_MORE:
        step(link, law, limits, sections, state, row, now[AT], now[LATE])
        yield True


@njit(cache=True, error_model="numpy")
def finish_ticks(sections, row, now):
    """Write a tick that was done in Python to the ring, at each `next`."""
    while now[AT] != NO_MORE:
        finish(sections, row, now[AT], now[LATE])
        yield True
