"""The law of `proxy` as a mere spring, compiled. Imports numba: the method imports this module inside `touch`.

What a touch remembers is listed in `contact`.
"""

# ruff: noqa: ANN001, ANN201 -- the types are in the signatures that numba compiles

from numba import float64, njit

from tangible_core.compiled.compiling import KERNEL

from ..contact.spring import MEMORY, SURFACE, spring
from ..surface.bilinear import NEWTONS


@njit(NEWTONS(*SURFACE, float64, MEMORY, *[float64] * 6), **KERNEL)
def spring_tick(
    coefficients, width_m, length_m, across_per_m, down_per_m, tiles_m, stiffness, memory, x, y, z, vx, vy, vz
):
    """F = k (p - q): as `proxy_kernels.tick` where all is one material that has neither friction nor damping."""
    shape = coefficients, width_m, length_m, across_per_m, down_per_m
    return spring(shape, tiles_m, stiffness, memory, x, y, z, vx, vy, vz)
