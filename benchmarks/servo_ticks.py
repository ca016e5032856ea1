"""What a whole tick costs: a Falcon's packet in, a law with friction and texture, the guard, a packet out, the ring."""

import statistics
from collections.abc import Iterator
from time import thread_time
from typing import Any, cast

import numpy as np
from numba import njit

from tangible_core import HapticSurface, load_method
from tangible_core.compiled.compiling import KERNEL
from tangible_core.compiled.kernels import Address
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import TICK_COLUMNS
from tangible_core.materials.assignment import library
from tangible_core.servo import Ring, Safety
from tangible_core.servo.ring import PERIOD_NS
from tangible_core.servo.ticks import cycle
from tangible_core.servo.ticks.loop import sections
from tangible_devices.falcon.calibration import Calibration
from tangible_devices.falcon.kernels import framing, kinematics, packet, tick

from .figures import Figure

TICKS, RUNS, PERIOD = 20_000, 9, 1_000_000
FRESH, NOW = framing.FRESH, tick.NOW
step = cycle.step
WITHOUT_CACHE = {**KERNEL, "cache": False}
MATERIAL = "sand"


def figures() -> Iterator[Figure]:
    """Yield the processor time of a whole tick, ns."""
    ring = Ring.create()
    try:
        arguments = _arguments(ring)
        packets = _packets()
        now = np.zeros(2, np.int64)
        _batch(packets[:100], now, *arguments)
        compiled = [_ns(lambda: _batch(packets, now, *arguments)) for _ in range(RUNS)]
        touching = float((ring.since(0)[0][:, cycle.FLAGS].astype(int) & 1).mean())
    finally:
        ring.remove()
    said = f"; in contact {100 * touching:.0f} % of the ticks"
    ns = statistics.median(compiled)
    what = f"whole tick: Falcon's packet to packet, proxy on {MATERIAL}, guard, ring"
    yield Figure(what, "<= 0.9 us nogil", f"{ns:.0f} ns{said}", ns <= 900)


def _arguments(ring: Ring) -> tuple[Any, ...]:
    turn = np.linspace(0, 8 * np.pi, 1024)
    heights = (0.002 + 0.001 * np.sin(turn)[:, None] * np.sin(turn)).astype(np.float32)
    labels = np.zeros(heights.shape, np.int32)
    surface = HapticSurface.from_heights(heights, labels=labels, materials=(library()[MATERIAL],))
    touch = load_method("render", "proxy")().touch(surface)
    assert isinstance(touch, CompiledTouch)
    calibration = Calibration()
    settings, memory = Safety().arrays(calibration.spec(), touch.stiffness_n_per_m)
    ring.guard[: memory.size] = memory
    ring.header[PERIOD_NS] = PERIOD
    of_link = tuple(_buffers(calibration))
    link = of_link, Address(tick.read), Address(tick.write)
    law = touch.fixed, touch.address(), touch.memory, touch.moving
    limits, row = (settings, ring.guard, ring.beacon.arrays), np.zeros(len(TICK_COLUMNS))
    return link, law, limits, sections(ring), np.zeros(cycle.STATE), row


def _buffers(calibration: Calibration) -> tick.Buffers:
    return tick.Buffers(
        answer=np.zeros(16, np.uint8),
        packet=np.zeros(16, np.uint8),
        counts=np.zeros(tick.COUNTS, np.int64),
        held=np.zeros(tick.HELD),
        history=np.zeros((16, 4)),
        arms=calibration.arms(),
        frame=calibration.frame(),
    )


def _packets() -> np.ndarray:
    calibration = Calibration()
    frame, arms = calibration.frame(), calibration.arms()
    turn = 0.08 * 1e-3 / 0.02 * np.arange(TICKS)
    places = np.column_stack([0.02 * np.cos(turn), 0.02 * np.sin(turn), np.full(TICKS, 0.001)])
    packets = np.zeros((TICKS, 16), np.uint8)
    kernels = cast(Any, kinematics)
    for place, data in zip((places - frame[:, 3]) @ frame[:, :3], packets, strict=True):
        counts = np.rint((np.array(kernels.inverse(*place)[:3]) - arms[:, 0]) / kinematics.RAD_PER_COUNT)
        cast(Any, packet).encode(*counts.astype(np.int64), 0, data)
        data[13] += packet.HOMED
    return packets


@njit(**WITHOUT_CACHE)
def _fill(packets, i, link, now):
    of_link = link[0]
    for k in range(packets.shape[1]):
        of_link[0][k] = packets[i, k]
    of_link[2][FRESH] = 1
    of_link[3][NOW] = i * 1e-3
    now[0] = i * PERIOD


@njit(**WITHOUT_CACHE)
def _batch(packets, now, link, law, limits, shared, state, row):
    for i in range(packets.shape[0]):
        _fill(packets, i, link, now)
        step(link, law, limits, shared, state, row, now[0], 0)


def _ns(work: Any) -> float:
    start = thread_time()
    work()
    return 1e9 * (thread_time() - start) / TICKS
