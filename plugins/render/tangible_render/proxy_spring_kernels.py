"""The law of `proxy` as a mere spring, compiled. Imports numba: the method imports this module inside `touch`.

What a touch remembers is listed in `contact`.
"""

# ruff: noqa: ANN001, ANN201 -- the types are in the signatures that numba compiles

import numpy as np
from numba import float64, njit

from tangible_core.compiled.compiling import KERNEL

from .contact.closest import settle
from .contact.contact import BESIDE, approach
from .contact.held import MEMORY, SURFACE
from .surface.bilinear import NEWTONS, cell


@njit(NEWTONS(*SURFACE, float64, MEMORY, *[float64] * 6), **KERNEL)
def spring_tick(
    coefficients, width_m, length_m, across_per_m, down_per_m, tiles_m, stiffness, memory, x, y, z, vx, vy, vz
):
    """F = k (p - q): as `proxy_kernels.tick` where all is one material that has neither friction nor damping.

    In a level tile that the proxy is in already, it is right above the hand.
    """
    if not approach(coefficients, width_m, length_m, across_per_m, down_per_m, tiles_m, memory, x, y, z, vx + vy + vz):
        return 0.0, 0.0, 0.0
    px, py, top = memory[0], memory[1], z
    row, column = cell(tiles_m.shape[0], tiles_m.shape[1], width_m, length_m, x, y)
    highest, lowest = tiles_m[row, column, 0], tiles_m[row, column, 1]
    if memory[7] == BESIDE:
        pass
    elif highest == lowest and (row, column) == cell(tiles_m.shape[0], tiles_m.shape[1], width_m, length_m, px, py):
        px, py, top = x, y, np.float64(highest)
    else:
        px, py, top, _, _, _ = settle(
            coefficients, width_m, length_m, across_per_m, down_per_m, px, py, x, y, z, 0.0, 0.0, 0.0
        )
    memory[0], memory[1], memory[2] = px, py, top
    fx, fy, fz = stiffness * (px - x), stiffness * (py - y), stiffness * (top - z)
    return (fx, fy, fz) if np.isfinite(fx + fy + fz) else (0.0, 0.0, 0.0)
