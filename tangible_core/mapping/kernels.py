"""A mapping around a device's kernels. Imports numba, when a mapped device is opened."""

# pyright: basic

from functools import cache
from typing import Any

import numpy as np
from numba import float64, int64, typeof, types, void

from ..compiled.compiling import KERNEL, njit
from ..compiled.kernels import Address
from ..compiled.touch import LinkKernels
from .placement import Placement

PLACEMENT: Any = typeof(Placement())
ARRAY = float64[::1]
VECTOR = types.UniTuple(float64, 3)
# Fields of a link's memory: the clutch's shift, the hand's last position, whether there is one, barred, muted.
DRIFT_X, DRIFT_Y, HAND_X, HAND_Y, STARTED, BARRED, MUTED = range(7)
MEMORY = 7


@njit(void(PLACEMENT, ARRAY, ARRAY), **KERNEL)
def place(to, memory, state):
    """Convert a device's state (x, y, z, vx, vy, vz, buttons) to the picture, in place."""
    x, y, z = state[0], state[1], state[2]
    is_held = int64(state[6]) & int64(to.clutch)
    if is_held and memory[STARTED]:
        memory[DRIFT_X] += x - memory[HAND_X]
        memory[DRIFT_Y] += y - memory[HAND_Y]
    memory[HAND_X], memory[HAND_Y], memory[STARTED] = x, y, 1.0
    within = abs(x) <= to.reach_x_m and abs(y) <= to.reach_y_m and abs(z) <= to.reach_z_m
    memory[BARRED] = 0.0 if within and not is_held else 1.0
    memory[MUTED] = max(memory[MUTED], memory[BARRED])
    x, y = x - to.offset_x_m - memory[DRIFT_X], y - to.offset_y_m - memory[DRIFT_Y]
    state[0] = to.centre_x_m + (to.cos * x + to.sin * y) / to.scale
    state[1] = to.centre_y_m + (to.cos * y - to.sin * x) / to.scale
    state[2] = (z - to.offset_z_m) / to.scale
    vx, vy = (0.0, 0.0) if is_held else (state[3], state[4])
    state[3] = (to.cos * vx + to.sin * vy) / to.scale
    state[4] = (to.cos * vy - to.sin * vx) / to.scale
    state[5] = state[5] / to.scale


@njit(VECTOR(PLACEMENT, ARRAY, float64, float64, float64), **KERNEL)
def push(to, memory, fx, fy, fz):
    """Return the force on the hand; zero while force is barred, and after that until the force law gives none."""
    # Otherwise a hand that came back deep inside the surface would be thrown out of it.
    if memory[MUTED]:
        if not memory[BARRED] and fx == 0.0 and fy == 0.0 and fz == 0.0:
            memory[MUTED] = 0.0
        return 0.0, 0.0, 0.0
    return to.cos * fx - to.sin * fy, to.sin * fx + to.cos * fy, fz


def _mapped_read(to, memory, fixed, read, write, state):
    fresh = read(*fixed, state)
    if fresh:
        place(to, memory, state)
    return fresh


def _mapped_write(to, memory, fixed, read, write, fx, fy, fz):
    x, y, z = push(to, memory, fx, fy, fz)
    write(*fixed, x, y, z)


def around(device: LinkKernels, to: Placement, memory: np.ndarray) -> LinkKernels:
    """Return kernels that call the device's by their addresses: compiled once for all devices, and cached on disk."""
    # the addresses come last: numba warns of a tuple that begins with a function
    arguments = (to, memory, device.fixed, Address(device.read), Address(device.write))
    kinds = [typeof(argument) for argument in arguments]
    return LinkKernels(
        _compile(_mapped_read, int64(*kinds, ARRAY)),
        _compile(_mapped_write, void(*kinds, float64, float64, float64)),
        arguments,
    )


@cache
def _compile(kernel, signature):
    return njit(signature, **KERNEL)(kernel)
