"""A beacon's tick, for loops in Python."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np

Pulling = Callable[[float, float, float, float, float, int], int]
"""(period_s, x, y, vx, vy, buttons) -> the tick's flags; the force is in the guard's memory."""


def pulling(beacon: tuple[np.ndarray, ...], memory: np.ndarray) -> Pulling:
    """Return the pull of a `BeaconMemory` with these `arrays`, for a guard with this memory."""
    from . import beacon_kernels

    kernel = cast(Any, beacon_kernels).pull

    def pull(period_s: float, x: float, y: float, vx: float, vy: float, buttons: int) -> int:
        return kernel(*beacon, memory, period_s, x, y, vx, vy, buttons)

    return pull
