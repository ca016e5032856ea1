"""The compiled kernel of `grey-level`. Imports numba: the method imports this module inside `touch`."""

import numpy as np
from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..surface.bilinear import GREYS, HEIGHTS, NEWTONS, cell, over

SURFACE = (HEIGHTS, GREYS, float64, float64, float64)


@njit(NEWTONS(*SURFACE, *[float64] * 6), **KERNEL)
def tick(height_m, grey, width_m, length_m, white_n, x, y, z, vx, vy, vz):
    """Compute F_z = white_n G / 255 below the height of the cell under the tip; zero in free air."""
    if not (over(width_m, length_m, x, y) and np.isfinite(z + vx + vy + vz)):
        return 0.0, 0.0, 0.0
    row, column = cell(height_m.shape[0], height_m.shape[1], width_m, length_m, x, y)
    if z >= np.float64(height_m[row, column]):
        return 0.0, 0.0, 0.0
    return 0.0, 0.0, white_n * grey[row, column] / 255.0
