"""The compiled kernel of `lateral-gradient` and `lateral-shape`. Imports numba: imported inside `touch`."""

import numpy as np
from numba import float64

from tangible_core.compiled import KERNEL, njit

from ..surface.bilinear import HEIGHTS, NEWTONS, over
from ..surface.spline import slope

SURFACE = (HEIGHTS, *[float64] * 6)


@njit(NEWTONS(*SURFACE, *[float64] * 6), **KERNEL)
def tick(coefficients, width_m, length_m, across_per_m, down_per_m, push_n, stiffness_n_per_m, x, y, z, vx, vy, vz):
    """Compute F = -(push_n + k d) grad h, where d = h - z > 0, and nothing along z; zero in free air."""
    if not (over(width_m, length_m, x, y) and np.isfinite(vx + vy + vz)):
        return 0.0, 0.0, 0.0
    height, slope_x, slope_y = slope(coefficients, across_per_m, down_per_m, x, y)
    depth = height - z
    if not depth > 0.0:
        return 0.0, 0.0, 0.0
    push = push_n + stiffness_n_per_m * depth
    fx, fy = -slope_x * push, -slope_y * push
    return (fx, fy, 0.0) if np.isfinite(fx + fy) else (0.0, 0.0, 0.0)
