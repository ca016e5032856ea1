"""A beacon's tick, for loops that are Python's."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np

Pulling = Callable[[float, float, float, float, float, int], int]
"""(period_s, x, y, vx, vy, buttons) -> the tick's flags. The force is left to the guard, in its memory."""


def pulling(beacon: tuple[np.ndarray, ...], memory: np.ndarray) -> Pulling:
    """The pull of a `BeaconMemory`, whose `arrays` these are, for a guard with this memory."""
    from . import beacon_kernels

    kernel = cast(Any, beacon_kernels).pull

    def pull(period_s: float, x: float, y: float, vx: float, vy: float, buttons: int) -> int:
        return kernel(*beacon, memory, period_s, x, y, vx, vy, buttons)

    return pull
