"""The compiled kernel of `force-shading`. Imports numba: the method imports this module inside `touch`."""

import math

import numpy as np
from numba import float32, float64, types

from tangible_core.compiled import KERNEL, njit

from ..surface.bilinear import HEIGHTS, LABELS, NEWTONS, TABLE, bilinear, cell, over

NORMALS = types.Array(float32, 3, "C", readonly=True)
SURFACE = (HEIGHTS, NORMALS, LABELS, TABLE, float64, float64)


@njit(NEWTONS(*SURFACE, *[float64] * 6), **KERNEL)
def tick(height_m, normal, labels, stiffness_n_per_m, width_m, length_m, x, y, z, vx, vy, vz):
    """Compute F = k d / sqrt(1 + |g|^2) n, where d = h - z > 0 and n is the interpolated normal; zero in free air."""
    if not (over(width_m, length_m, x, y) and np.isfinite(vx + vy + vz)):
        return 0.0, 0.0, 0.0
    height, slope_x, slope_y = bilinear(height_m, width_m, length_m, x, y)
    depth = height - z
    if not depth > 0.0:
        return 0.0, 0.0, 0.0
    nx = bilinear(normal[0], width_m, length_m, x, y)[0]
    ny = bilinear(normal[1], width_m, length_m, x, y)[0]
    nz = bilinear(normal[2], width_m, length_m, x, y)[0]
    row, column = cell(labels.shape[0], labels.shape[1], width_m, length_m, x, y)
    facet = math.sqrt((1.0 + slope_x * slope_x + slope_y * slope_y) * (nx * nx + ny * ny + nz * nz))
    push = stiffness_n_per_m[labels[row, column]] * depth / facet
    return (push * nx, push * ny, push * nz) if np.isfinite(push) else (0.0, 0.0, 0.0)
