"""Timing of this machine at present: the lateness of its wake-ups, and the duration of a tick."""

import time
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from ..compiled.touch import CompiledTouch
from ..data import HapticState, Record
from ..plugins.interfaces import Touch
from ..runtime.system.priority import real_time as real_time_block

TICKS = 2000
PERCENTILES = {"p50": 50.0, "p99": 99.0, "p99.9": 99.9, "max": 100.0}


@dataclass(frozen=True, eq=False)
class Lateness(Record):
    """The lateness of each tick of a loop without work."""

    late_s: Float64[np.ndarray, " n"]
    period_s: float
    real_time: bool
    """True if the loop ran, and so may run, with real-time priority, such as SCHED_FIFO of Linux."""

    @property
    def overruns(self) -> float:
        """Share of ticks that began more than a period late."""
        return float(np.mean(self.late_s > self.period_s))

    def at(self, percent: float) -> float:
        """Return a percentile of the lateness, seconds."""
        return float(np.percentile(self.late_s, percent))


@dataclass(frozen=True, eq=False)
class TickCost(Record):
    """The duration of a tick of the force law."""

    call_s: Float64[np.ndarray, " n"]
    kernel_s: float
    """Mean duration along a path, without the call from Python."""
    is_compiled: bool = True

    def at(self, percent: float) -> float:
        """Return a percentile of the calls' duration, seconds."""
        return float(np.percentile(self.call_s, percent))


def measure_lateness(seconds: float, period_s: float) -> Lateness:
    """Measure the lateness of sleeps to absolute deadlines, in real time if that is permitted."""
    late_s = np.zeros(max(1, round(seconds / period_s)))
    with real_time_block() as real_time:
        deadline = time.perf_counter()
        for tick in range(late_s.size):
            deadline += period_s
            if (wait := deadline - time.perf_counter()) > 0:
                time.sleep(wait)
            late = time.perf_counter() - deadline
            late_s[tick] = late
            # A tick that is more than a period late takes the next deadline to come.
            deadline += late // period_s * period_s
    return Lateness(late_s, period_s, real_time)


def measure_ticks(touch: Touch, way_m: Float64[np.ndarray, "n 3"], period_s: float) -> TickCost:
    """Time the touch along a path, one position a tick, after a warm-up lap."""
    touch.path(way_m, period_s)
    start = time.perf_counter()
    touch.path(way_m, period_s)
    kernel_s = (time.perf_counter() - start) / len(way_m)
    velocity = np.gradient(way_m, period_s, axis=0) if len(way_m) > 1 else np.zeros_like(way_m)
    states = [
        HapticState((x, y, z), (vx, vy, vz))
        for (x, y, z), (vx, vy, vz) in zip(way_m.tolist(), velocity.tolist(), strict=True)
    ]
    clock = np.empty(len(states) + 1, np.int64)
    clock[0] = time.perf_counter_ns()
    for tick, state in enumerate(states, 1):
        touch.force(state)
        clock[tick] = time.perf_counter_ns()
    return TickCost(1e-9 * np.diff(clock), kernel_s, isinstance(touch, CompiledTouch))
