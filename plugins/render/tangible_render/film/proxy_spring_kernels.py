"""The law of `proxy` as a mere spring, on a surface that moves; compiled. Imports numba: imported inside `film`.

What a touch remembers is listed in `contact`.
"""

# ruff: noqa: ANN001, ANN201 -- the types are in the signatures that numba compiles

from numba import float64, njit

from tangible_core.compiled.compiling import KERNEL

from ..contact.spring import MEMORY, spring
from ..surface.bilinear import NEWTONS
from .playing import MOVING, MOVING_SURFACE, play, write_rise
from .steady import STEADY, steady


@njit(NEWTONS(*MOVING_SURFACE, float64, MEMORY, STEADY, MOVING, *[float64] * 6), **KERNEL)
def moving_spring_tick(
    pairs, tiles_m, frames, shared, count, width_m, length_m, across_per_m, down_per_m, stiffness, memory, last, moving,
    x, y, z, vx, vy, vz,
):  # fmt: skip
    """As `proxy_spring_kernels.spring_tick`, on the surface as it is at the end of this tick."""
    slot, share, passed = play(frames, shared, count, moving)
    shape = (pairs[slot], 1.0 - share, share), width_m, length_m, across_per_m, down_per_m
    fx, fy, fz = spring(shape, tiles_m[slot], stiffness, memory, x, y, z, vx, vy, vz)
    write_rise(pairs[slot], across_per_m, down_per_m, passed, memory, moving)
    return steady(last, moving, x, y, z, vx, vy, vz, fx, fy, fz)
