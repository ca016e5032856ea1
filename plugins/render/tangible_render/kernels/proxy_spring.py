"""The compiled kernel of `proxy` as a spring alone. Imports numba: the method imports this module inside `touch`."""

from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..contact.spring import MEMORY, SURFACE, spring
from ..surface.bilinear import NEWTONS


@njit(NEWTONS(*SURFACE, float64, MEMORY, *[float64] * 6), **KERNEL)
def spring_tick(
    coefficients, width_m, length_m, across_per_m, down_per_m, tiles_m, stiffness, memory, x, y, z, vx, vy, vz
):
    """Compute F = k (p - q): `proxy.tick` for one material without friction and damping."""
    shape = coefficients, width_m, length_m, across_per_m, down_per_m
    return spring(shape, tiles_m, stiffness, memory, x, y, z, vx, vy, vz)
