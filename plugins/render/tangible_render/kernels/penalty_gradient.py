"""The compiled kernel of `penalty-gradient`. Imports numba: the method imports this module inside `touch`."""

import numpy as np
from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..surface.bilinear import HEIGHTS, LABELS, NEWTONS, TABLE, bilinear, cell, over

SURFACE = (HEIGHTS, LABELS, TABLE, float64, float64, float64)


@njit(NEWTONS(*SURFACE, *[float64] * 6), **KERNEL)
def tick(height_m, labels, stiffness_n_per_m, width_m, length_m, damping_n_s_per_m, x, y, z, vx, vy, vz):
    """Compute F = max(0, k d - b v.(-g, 1) / (1 + |g|^2)) (-g, 1), where d = h - z > 0; zero in free air."""
    if not over(width_m, length_m, x, y):
        return 0.0, 0.0, 0.0
    height, slope_x, slope_y = bilinear(height_m, width_m, length_m, x, y)
    depth = height - z
    if not depth > 0.0:
        return 0.0, 0.0, 0.0
    row, column = cell(labels.shape[0], labels.shape[1], width_m, length_m, x, y)
    spring = stiffness_n_per_m[labels[row, column]] * depth
    outward = (vz - slope_x * vx - slope_y * vy) / (1.0 + slope_x * slope_x + slope_y * slope_y)
    push = max(spring - damping_n_s_per_m * outward, 0.0)
    fx, fy = -slope_x * push, -slope_y * push
    if not (np.isfinite(outward) and np.isfinite(fx) and np.isfinite(fy) and np.isfinite(push)):
        return 0.0, 0.0, 0.0
    return fx, fy, push
