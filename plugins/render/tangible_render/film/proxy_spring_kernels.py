"""The compiled kernel of `proxy` as a spring alone, on a moving surface. Imports numba: imported inside `film`."""

from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..contact.spring import MEMORY, spring
from ..surface.bilinear import NEWTONS
from .playing import MOVING, MOVING_SURFACE, play, write_rise
from .steady import STEADY, steady


@njit(NEWTONS(*MOVING_SURFACE, float64, MEMORY, STEADY, MOVING, *[float64] * 6), **KERNEL)
def moving_spring_tick(
    pairs, tiles_m, frames, shared, count, width_m, length_m, across_per_m, down_per_m, stiffness, memory, last, moving,
    x, y, z, vx, vy, vz,
):  # fmt: skip
    """Compute `kernels.proxy_spring.spring_tick` on the surface at the end of this tick."""
    slot, share, part = play(frames, shared, count, moving)
    shape = (pairs[slot], 1.0 - share, share), width_m, length_m, across_per_m, down_per_m
    fx, fy, fz = spring(shape, tiles_m[slot], stiffness, memory, x, y, z, vx, vy, vz)
    write_rise(pairs[slot], across_per_m, down_per_m, part, memory, moving)
    return steady(last, moving, x, y, z, vx, vy, vz, fx, fy, fz)
