"""A limit on the change of force due to a moving surface; imports numba: import it inside a verb."""

import math

import numpy as np
from jaxtyping import Float64
from numba import float64

from tangible_core.compiled import RISE_M, inner

from ..contact.approach import LEAP_M
from .slots import STEP_N

STEADY = float64[::1]
# Places in the memory: the law's stiffness and damping; the last force, hand and velocity; a flag; its length.
STIFFNESS, DAMPING, FORCE, HAND, SPEED, LATE, REMEMBERED = 0, 1, 2, 5, 8, 11, 12
# The additional way of the point as a multiple of the hand's: it then slides off a ridge as on a still surface.
REACH = 8.0


@inner(forceinline=True)
def steady(memory, moving, x, y, z, vx, vy, vz, fx, fy, fz):
    """Return the force law's force, its change limited for this tick; a slide may last longer than a frame."""
    # A small motion of the surface may free the proxy: the ridge that held it sinks, or the ground falls away while the
    # proxy still hangs on a wall. The spring's loss is then spread over several ticks: the point that pulls at the hand
    # moves straight from its last place to the proxy, no faster than the limit for a hand at rest, or as the hand
    # itself moves. It is never further from the hand than at an end of its way, so that its energy comes from hand and
    # surface alone. For a limited force, `moving` gets the rise that does the same work on it as the surface did.
    stiffness = memory[STIFFNESS]
    dx, dy, dz = x - memory[HAND], y - memory[HAND + 1], z - memory[HAND + 2]
    ux, uy, uz = vx - memory[SPEED], vy - memory[SPEED + 1], vz - memory[SPEED + 2]
    moved_m = math.sqrt(dx * dx + dy * dy + dz * dz)
    held_x, held_y = memory[FORCE] - stiffness * dx, memory[FORCE + 1] - stiffness * dy
    held_z = memory[FORCE + 2] - stiffness * dz
    late, was_late = 0.0, memory[LATE] > 0.0
    if moved_m <= LEAP_M:  # False for NaN and for a hand that was put down elsewhere
        step_n = STEP_N + REACH * stiffness * moved_m + memory[DAMPING] * math.sqrt(ux * ux + uy * uy + uz * uz)
        ax, ay, az = fx - held_x, fy - held_y, fz - held_z
        away_n = math.sqrt(ax * ax + ay * ay + az * az)
        if away_n > step_n:
            part, late = step_n / away_n, 1.0
            fx, fy, fz = held_x + part * ax, held_y + part * ay, held_z + part * az
        if late + was_late > 0.0:
            more = fx * fx + fy * fy + fz * fz - held_x * held_x - held_y * held_y - held_z * held_z
            upwards = stiffness * (fz + memory[FORCE + 2])
            moving[RISE_M] = min(max(more, 0.0) / upwards, STEP_N / stiffness) if upwards > 0.0 else 0.0
    if not np.isfinite(fx + fy + fz):
        fx, fy, fz = 0.0, 0.0, 0.0
    memory[FORCE], memory[FORCE + 1], memory[FORCE + 2] = fx, fy, fz
    memory[HAND], memory[HAND + 1], memory[HAND + 2] = x, y, z
    memory[SPEED], memory[SPEED + 1], memory[SPEED + 2] = vx, vy, vz
    memory[LATE] = late
    return fx, fy, fz


def initial_memory(stiffness_n_per_m: float, damping_n_s_per_m: float) -> Float64[np.ndarray, "n"]:
    """Return the memory before the first tick."""
    memory = np.zeros(REMEMBERED)
    memory[STIFFNESS], memory[DAMPING], memory[HAND] = stiffness_n_per_m, damping_n_s_per_m, np.nan
    return memory
