"""The compiled kernel of `penalty`. Imports numba: the method imports this module inside `touch`."""

import numpy as np
from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..surface.bilinear import HEIGHTS, LABELS, NEWTONS, TABLE, cell, over
from ..surface.spline import height

SURFACE = (HEIGHTS, *[float64] * 4, LABELS, TABLE, float64)


@njit(NEWTONS(*SURFACE, *[float64] * 6), **KERNEL)
def tick(
    coefficients, width_m, length_m, across_per_m, down_per_m, labels, stiffness, damping_n_s_per_m, x, y, z, vx, vy, vz
):
    """Compute F_z = max(0, k d - b v_z), where d = h - z > 0; zero in free air."""
    if not over(width_m, length_m, x, y):
        return 0.0, 0.0, 0.0
    depth = height(coefficients, across_per_m, down_per_m, x, y) - z
    if not depth > 0.0:
        return 0.0, 0.0, 0.0
    row, column = cell(labels.shape[0], labels.shape[1], width_m, length_m, x, y)
    push = max(stiffness[labels[row, column]] * depth - damping_n_s_per_m * vz, 0.0)
    return (0.0, 0.0, push) if np.isfinite(push) and np.isfinite(vx + vy + vz) else (0.0, 0.0, 0.0)
