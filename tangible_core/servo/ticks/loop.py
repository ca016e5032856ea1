"""The force loop for a device and a force law: all compiled, with a compiled tick, or with a tick in Python."""

import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, cast

import numpy as np

from ...compiled.touch import FRAME, RISE_M, CompiledLink, CompiledTouch, motion_array
from ...data import TICK_COLUMNS, Force, HapticState, TickFlag
from ...plugins.interfaces import Link, Touch
from ...runtime.system.timers import now_ns
from ..guard import layout
from ..ring import COUNT, LEAD_NS, MARKS, NEXT_NS, PERIOD_NS, PREVIOUS_NS, SPINS, START_NS, STOP, SWAP, Ring
from .schedule import begin_tick, going

SECOND_NS = 1_000_000_000
# The sections of a ring that kernels write to: header, sums, late, period, contact, stamps, ticks.
Sections = tuple[np.ndarray, ...]
Limits = tuple[np.ndarray, np.ndarray, tuple[np.ndarray, ...]]
"""Settings and memory of a guard, and the arrays of a `BeaconMemory`."""
Timed = Callable[[int, int], None]  # (at_ns, late_ns): does one tick, which began at at_ns, late_ns late
FAR = HapticState((0.0, 0.0, 1.0))  # a place in free air, above any surface
# (state, seconds since the state before) -> the allowed force, and the sum of its `TickFlag`s.
GuardedForce = Callable[[HapticState, float], tuple[Force, int]]
# (seconds since the tick before) -> the force of a tick without a fresh state, and its flags.
HeldForce = Callable[[float], tuple[Force, int]]


class Loop(NamedTuple):
    """A loop that is ready to run, once."""

    run: Callable[[], None]
    how: str
    """A sentence about the kind of loop."""


class Kernel(NamedTuple):
    """A generator of `cycle`, and the two numbers that it reads."""

    ticks: Iterator[bool]
    now: np.ndarray

    def end(self) -> None:
        """Run the generator to its end, so that it releases its arguments."""
        from .cycle import NO_MORE

        self.now[:] = NO_MORE
        next(self.ticks, None)


def prepare(link: Link, touch: Touch, ring: Ring, settings: np.ndarray) -> Loop:
    """Return the fastest loop for this device and force law, with all kernels compiled or loaded."""
    from ..guard import guard
    from . import clock, cycle

    cast(Any, guard).restart(np.zeros_like(ring.guard))  # `take_over` needs it between two ticks
    kernels = cast(Any, cycle)
    row = np.full(len(TICK_COLUMNS), np.nan)
    arrays, limits = sections(ring), (settings, ring.guard, ring.beacon.arrays)
    if not isinstance(link, CompiledLink) or not isinstance(touch, CompiledTouch):
        return Loop(_timed_loop(*_plain_tick(link, touch, limits, arrays, row), arrays[0]), "the tick is in Python")
    kernel_arguments = (*_kernels(link, touch), limits)
    state = np.zeros(cycle.STATE)
    if clock.SLEEPS and not link.exchanges:
        ticking = clock.clock()
        kernels.run(ticking, *kernel_arguments, _stopped_sections(arrays), state, row)
        return Loop(lambda: kernels.run(ticking, *kernel_arguments, arrays, state, row), "the whole loop is compiled")
    kernel = _start_generator(kernels.ticks, *kernel_arguments, arrays, state, row)

    def exchange_then_tick(at_ns: int, late_ns: int) -> None:
        link.exchange()
        kernel.now[:] = at_ns, late_ns
        next(kernel.ticks)

    return Loop(_timed_loop(exchange_then_tick, kernel, arrays[0]), "the tick is compiled, Python calls the device")


def sections(ring: Ring) -> Sections:
    """Return the sections of a ring that kernels write to."""
    return ring.header, ring.sums, ring.late, ring.period, ring.contact, ring.stamps, ring.ticks


def start_clock(header: np.ndarray, real_time: bool) -> None:
    """Schedule the first tick a period from now."""
    header[START_NS] = now_ns() + header[PERIOD_NS]
    header[NEXT_NS] = header[START_NS]
    header[SPINS] = real_time


def take_over(ring: Ring) -> None:
    """Go on with a new scene, whose force fades in; this ends a beacon, which pulled to a part of the scene before."""
    from ..guard import guard

    cast(Any, guard).restart(ring.guard)
    ring.beacon.leave()
    ring.header[MARKS] |= int(TickFlag.SWAPPED)
    ring.header[SWAP] = 0


def _kernels(link: CompiledLink, touch: CompiledTouch) -> tuple[Any, Any]:
    from ...compiled.kernels import Address

    read, write, of_link = link.kernels()
    return (of_link, Address(read), Address(write)), (touch.fixed, touch.address(), touch.memory, touch.moving)


def _stopped_sections(arrays: Sections) -> Sections:
    """Return the sections with a header that stops a loop before its first tick."""
    header = np.zeros_like(arrays[0])
    header[STOP] = 1
    return header, *arrays[1:]


def _start_generator(generator: Callable[..., Iterator[bool]], *arguments: Any) -> Kernel:
    """Start a generator of `cycle`, so that it is compiled or loaded now, not in the first tick."""
    first, kernel = (Kernel(generator(*arguments, now), now) for now in np.zeros((2, 2), np.int64))
    first.end()
    return kernel


def _plain_tick(link: Link, touch: Touch, limits: Limits, arrays: Sections, row: np.ndarray) -> tuple[Timed, Kernel]:
    """Return a tick for a device or a force law that is not a kernel."""
    from . import cycle

    proxy, moving = touch.memory[:3] if isinstance(touch, CompiledTouch) else np.full(3, np.nan), motion_array(touch)
    settings, memory, beacon = limits
    header, allowed_force = arrays[0], guard_touch(touch, settings, memory, beacon)
    held_force = hold_force(settings, memory)
    # Whatever the law compiles is compiled before the first tick.
    touch.force(FAR)
    kernel = _start_generator(cast(Any, cycle).finish_ticks, arrays, row)

    def tick(at_ns: int, late_ns: int) -> None:
        period_s = (at_ns - header[PREVIOUS_NS] if header[COUNT] else header[PERIOD_NS]) / SECOND_NS
        state = link.read()
        force, flags = allowed_force(state, period_s) if link.fresh else held_force(period_s)
        link.write(force)
        began = (at_ns - header[START_NS]) / SECOND_NS, late_ns / SECOND_NS
        motion = *state.position_m, *state.velocity_m_per_s, *proxy, *link.applied
        row[:] = (*began, *motion, flags, state.buttons, moving[FRAME])
        kernel.now[:] = at_ns, late_ns
        next(kernel.ticks)

    return tick, kernel


def _timed_loop(tick: Timed, kernel: Kernel, header: np.ndarray) -> Callable[[], None]:
    """Return a loop in Python around a tick, at whose end the kernel ends too."""

    def run() -> None:
        try:
            while going(header):
                tick(*_begin(header))
        finally:
            kernel.end()

    return run


def _begin(header: np.ndarray) -> tuple[int, int]:
    """Wait for the next tick, as `cycle.begin`, in a loop in Python."""
    due_ns, lead_ns = header[[NEXT_NS, LEAD_NS]].tolist()
    at_ns = now_ns()
    if at_ns < due_ns - lead_ns:
        time.sleep((due_ns - lead_ns - at_ns) / SECOND_NS)
        at_ns = now_ns()
    while at_ns < due_ns:
        at_ns = now_ns()
    return at_ns, int(begin_tick(header, at_ns))


def guard_touch(
    touch: Touch, settings: np.ndarray, memory: np.ndarray, beacon: tuple[np.ndarray, ...] | None = None
) -> GuardedForce:
    """Return a function that asks the touch for its force and passes on what the guard allows."""
    from ..guard import guard

    couple, allow = cast(Any, guard).couple, cast(Any, guard).guard
    moving = motion_array(touch)
    pull: Any = None
    if beacon is not None:
        from .. import beacon_kernels

        pull = cast(Any, beacon_kernels).pull

    def allowed_force(state: HapticState, period_s: float) -> tuple[Force, int]:
        device = *state.position_m, *state.velocity_m_per_s
        x, y, z, vx, vy, vz = couple(settings, memory, period_s, *device)
        law_force = touch.force(HapticState((x, y, z), (vx, vy, vz), state.time_s, state.buttons))
        memory[layout.RISE_M] = moving[RISE_M]
        flags = 0 if beacon is None else pull(*beacon, memory, period_s, x, y, vx, vy, state.buttons)
        fx, fy, fz, guard_flags = allow(settings, memory, period_s, *device, *law_force)
        return Force(fx, fy, fz), flags | guard_flags

    return allowed_force


def hold_force(settings: np.ndarray, memory: np.ndarray) -> HeldForce:
    """Return a function that passes on the last force of the same guard, and zero from `stale_s` on."""
    from ..guard import guard

    wait = cast(Any, guard).wait

    def held_force(period_s: float) -> tuple[Force, int]:
        fx, fy, fz, flags = wait(settings, memory, period_s)
        return Force(fx, fy, fz), flags

    return held_force
