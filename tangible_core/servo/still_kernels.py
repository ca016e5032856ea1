"""The kernel of `still`. Imports numba: what uses this module imports it inside its verb."""

# ruff: noqa: ANN001, ANN201 -- the types are in the signatures that numba compiles
# pyright: basic

from numba import float64, njit, types

from ..compiled.compiling import KERNEL


@njit(types.UniTuple(float64, 3)(*[float64] * 6), **KERNEL)
def tick(x, y, z, vx, vy, vz):
    """Nothing."""
    return 0.0, 0.0, 0.0
