"""A stub for a force law in Python where a kernel calls a compiled one, alone so that it is compiled where needed."""

from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..surface.bilinear import NEWTONS


@njit(NEWTONS(float64[::1], float64[::1], *[float64] * 6), **KERNEL)
def stub_law(state, force_n, x, y, z, vx, vy, vz):
    """Record the position and velocity passed in, and return the force stored before."""
    state[0], state[1], state[2], state[3], state[4], state[5] = x, y, z, vx, vy, vz
    return force_n[0], force_n[1], force_n[2]
