"""Which loop suits a device and a law: compiled as a whole, a compiled tick, or a tick of Python's."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np

from ..compiled import CompiledLink, CompiledTouch
from ..data import TICK_COLUMNS, Force, HapticState, TickFlag
from ..interfaces import Link, Touch
from .ring import (
    COMMAND,
    COUNT,
    LAST,
    MARKS,
    NEXT_NS,
    OVERRUNS,
    PERIOD_NS,
    PREVIOUS_NS,
    RUN,
    SPINS,
    START_NS,
    STOP,
    Ring,
)

SECOND_NS = 1_000_000_000
Sections = tuple[np.ndarray, ...]
"""Of a ring, as the kernels take them: header, sums, late, period, stamps, ticks."""
Timed = Callable[[int, int], None]
"""(at_ns, late_ns): one tick, which began then and so late."""


class Loop(NamedTuple):
    """A loop ready to run."""

    run: Callable[[], None]
    how: str


def prepare(link: Link, touch: Touch, ring: Ring, settings: np.ndarray) -> Loop:
    """The fastest loop that this device and this law allow; what it needs is compiled or loaded before this returns."""
    from . import clock, cycle

    kernels, sleeps = cast(Any, cycle), clock.SLEEPS
    row = np.full(len(TICK_COLUMNS), np.nan)
    shared, limits = sections(ring), (settings, ring.guard)
    ticking = clock.clock() if sleeps else None
    if not isinstance(link, CompiledLink) or not isinstance(touch, CompiledTouch):
        tick = _plain(link, touch, limits, shared, row)
        return Loop(_timed(tick, shared, ticking), "the tick is Python's")
    fixed = (*_kernels(link, touch), limits)
    state = np.zeros(cycle.STATE)
    if sleeps and not link.exchanges:
        kernels.run(ticking, *fixed, _stopped(shared), state, row)
        return Loop(lambda: kernels.run(ticking, *fixed, shared, state, row), "the whole loop is compiled")
    kernels.step(*fixed, _stopped(shared), state, row, 0, 0)

    def exchanged(at_ns: int, late_ns: int) -> None:
        link.exchange()
        kernels.step(*fixed, shared, state, row, at_ns, late_ns)

    return Loop(_timed(exchanged, shared, ticking), "the tick is compiled, Python asks the device")


def sections(ring: Ring) -> Sections:
    """What the kernels write to."""
    return ring.header, ring.sums, ring.late, ring.period, ring.stamps, ring.ticks


def start_clock(header: np.ndarray, real_time: bool) -> None:
    """The first tick is due a period from now."""
    header[START_NS] = time.monotonic_ns() + header[PERIOD_NS]
    header[NEXT_NS] = header[START_NS]
    header[SPINS] = real_time


def take_over(ring: Ring) -> None:
    """Go on with a new scene, whose force fades in."""
    from . import guard

    cast(Any, guard).restart(ring.guard)
    ring.header[MARKS] |= int(TickFlag.SWAPPED)
    ring.header[COMMAND] = RUN


def _kernels(link: CompiledLink, touch: CompiledTouch) -> tuple[Any, Any]:
    from ..kernels import Address

    read, write, of_link = link.kernels()
    return (of_link, Address(read), Address(write)), (touch.fixed, Address(touch.tick), touch.memory)


def _stopped(shared: Sections) -> Sections:
    """The same with a header that lets no tick happen."""
    header = np.zeros_like(shared[0])
    header[COMMAND] = STOP
    return header, *shared[1:]


def _plain(link: Link, touch: Touch, limits: tuple[np.ndarray, np.ndarray], shared: Sections, row: np.ndarray) -> Timed:
    """A tick for a device or a law that is no kernel."""
    from . import coupling, cycle, guard

    proxy = touch.memory[:3] if isinstance(touch, CompiledTouch) else np.full(3, np.nan)
    header = shared[0]
    couple, allow, finish = cast(Any, coupling).couple, cast(Any, guard).guard, cast(Any, cycle).finish
    finish(tuple(map(np.zeros_like, shared)), row, 0, 0)  # compiled or loaded now, not in the first tick

    def tick(at_ns: int, late_ns: int) -> None:
        period_s = (at_ns - header[PREVIOUS_NS] if header[COUNT] else header[PERIOD_NS]) / SECOND_NS
        state = link.read()
        device = *state.position_m, *state.velocity_m_per_s
        tool = couple(*limits, period_s, *device)
        wanted = touch.force(HapticState(tool[:3], tool[3:], state.time_s, state.buttons))
        *force, flags = allow(*limits, period_s, *device, *wanted)
        link.write(Force(*force))
        begun = (at_ns - header[START_NS]) / SECOND_NS, late_ns / SECOND_NS
        row[:] = (*begun, *device, *proxy, *link.applied, flags, state.buttons)
        finish(shared, row, at_ns, late_ns)

    return tick


def _timed(tick: Timed, shared: Sections, ticking: Any) -> Callable[[], None]:
    """A loop of Python's around a tick; the waiting is compiled where it can be."""
    from . import cycle

    header = shared[0]
    begin = cast(Any, cycle).begin
    if ticking:
        begin(ticking, np.ones_like(header))  # compiled or loaded now

    def run() -> None:
        while header[COMMAND] == RUN and header[COUNT] < header[LAST]:
            tick(*(begin(ticking, header) if ticking else _begin(header)))

    return run


def _begin(header: np.ndarray) -> tuple[int, int]:
    """`cycle.begin` where compiled code cannot sleep."""
    due_ns, period_ns = int(header[NEXT_NS]), int(header[PERIOD_NS])
    time.sleep(max(0, due_ns - time.monotonic_ns()) / SECOND_NS)
    at_ns = time.monotonic_ns()
    missed = max(0, at_ns - due_ns) // period_ns
    header[OVERRUNS] += missed
    header[NEXT_NS] = due_ns + (missed + 1) * period_ns
    return at_ns, at_ns - due_ns
