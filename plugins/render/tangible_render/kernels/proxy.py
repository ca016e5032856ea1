"""The compiled kernel of `proxy` on materials. Imports numba: the method imports this module inside `touch`."""

from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..contact.spring import MATERIALS, MEMORY, SURFACE, spring_and_damper
from ..surface.bilinear import LABELS, NEWTONS


@njit(NEWTONS(*SURFACE, LABELS, MATERIALS, MEMORY, *[float64] * 6), **KERNEL)
def tick(
    coefficients, width_m, length_m, across_per_m, down_per_m, tiles_m, labels, table, memory, x, y, z, vx, vy, vz
):
    """Compute F = k (p - q) - b v_n n, the proxy p held by friction; table: a row k, b, mu_s, mu_d for each label."""
    shape = coefficients, width_m, length_m, across_per_m, down_per_m
    return spring_and_damper(shape, tiles_m, labels, table, memory, x, y, z, vx, vy, vz)
