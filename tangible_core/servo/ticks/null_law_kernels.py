"""The kernel of the null force law. Imports numba: its users import this module inside their verbs."""

# pyright: basic

from numba import float64, types

from ...compiled.compiling import KERNEL, njit


@njit(types.UniTuple(float64, 3)(*[float64] * 6), **KERNEL)
def tick(x, y, z, vx, vy, vz):
    """Return zero force."""
    return 0.0, 0.0, 0.0
