"""A stress test of a device: rate and jitter of reading and writing."""

import time
from array import array
from typing import Any

import numpy as np

from tangible_core.data import NO_FORCE
from tangible_core.plugins.interfaces import HapticDevice

WARM_UP = 100
"""Number of cycles before the measurement."""
MOST_CYCLES = 10_000_000
"""Greatest number of cycles, as all of their times are in memory."""


def stress_device(device: HapticDevice, seconds: float) -> dict[str, Any]:
    """Measure the rate, and percentiles of the time of one read and one write. Raises: DeviceError as the device."""
    spent_ns = array("q")
    with device.open() as link:
        for _ in range(WARM_UP):
            link.read()
            link.write(NO_FORCE)
        start = last = time.perf_counter_ns()
        end = start + round(seconds * 1e9)
        while last < end and len(spent_ns) < MOST_CYCLES:
            link.read()
            link.write(NO_FORCE)
            now = time.perf_counter_ns()
            spent_ns.append(now - last)
            last = now
    spent_us = np.array(spent_ns) / 1e3
    p50, p99, p999 = np.percentile(spent_us, (50, 99, 99.9)).tolist()
    return {
        "cycles": spent_us.size,
        "rate_hz": 1e9 * spent_us.size / (last - start),
        "p50_us": p50,
        "p99_us": p99,
        "p99_9_us": p999,
        "max_us": float(spent_us.max()),
    }
