"""A surface with parts for the tests of beacons, and the pull of a beacon on it."""

from typing import Any, cast

import numpy as np

from tangible_core.data import HapticSurface, Relief
from tangible_core.servo import beacon_kernels, beacon_to
from tangible_core.servo.beacon import RAMP_S, BeaconMemory
from tangible_core.servo.guard import layout

WIDTH_M, LENGTH_M = 0.08, 0.06
NAMES = ("ground", "disc", "", "disc ", "arc")
T = 0.001
kernels = cast(Any, beacon_kernels)


def in_parts() -> HapticSurface:
    """Return a level surface of 80 x 60 mm: a disc of 5 mm, a bar one cell wide, a single cell, and an arc."""
    rows, columns = 120, 160
    y, x = np.mgrid[:rows, :columns]
    x_m, y_m = ((x + 0.5) / columns - 0.5) * WIDTH_M, (0.5 - (y + 0.5) / rows) * LENGTH_M
    labels = np.zeros((rows, columns), np.int32)
    labels[np.hypot(x_m - 0.02, y_m - 0.01) < 0.005] = 1
    labels[100, 30:70] = 2
    labels[10, 10] = 3
    labels[(abs(np.hypot(x_m, y_m) - 0.025) < 0.001) & (x_m < 0.01)] = 4
    relief = Relief(np.full(labels.shape, 0.002, np.float32), (WIDTH_M, LENGTH_M))
    return HapticSurface(relief, labels, None, NAMES)


SURFACE = in_parts()
PARTS = [1, 2, 3, 4]


def pulls(memory: BeaconMemory, states: np.ndarray, buttons: int = 0, ticks: int = 1) -> np.ndarray:
    """Return the pull in a guard's memory at states x, y, vx, vy, after a number of ticks at each."""
    kept = np.zeros(layout.MEMORY)
    found = []
    for x, y, vx, vy in states.tolist():
        for _ in range(ticks):
            kernels.pull(*memory.arrays, kept, T, x, y, vx, vy, buttons)
        found.append(kept[layout.PULL : layout.PULL + 2].copy())
    return np.array(found)


def faded_in(part: int) -> BeaconMemory:
    memory = BeaconMemory.of(beacon_to(SURFACE, part))
    pulls(memory, np.zeros((1, 4)), ticks=round(RAMP_S / T) + 2)
    return memory
