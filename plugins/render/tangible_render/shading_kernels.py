"""The law of `force-shading`, compiled. Imports numba: the method imports this module inside `touch`."""

# ruff: noqa: ANN001, ANN201 -- the types are in the signatures that numba compiles

import math

import numpy as np
from numba import float32, float64, njit, types, void

from .bilinear import FORCES, HEIGHTS, LABELS, NEWTONS, POINTS, TABLE, bilinear, cell, over, step_velocity

NORMALS = types.Array(float32, 3, "C", readonly=True)
SURFACE = (HEIGHTS, NORMALS, LABELS, TABLE, float64, float64)


@njit(NEWTONS(*SURFACE, *[float64] * 6), cache=True, nogil=True, error_model="numpy")
def tick(height_m, normal, labels, stiffness_n_per_m, width_m, length_m, x, y, z, vx, vy, vz):
    """F = k d / sqrt(1 + |g|^2) n, where d = h - z > 0 and n is the normal between the cells'; zero in free air."""
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


@njit(void(*SURFACE, POINTS, float64, FORCES), cache=True, nogil=True, error_model="numpy")
def along(height_m, normal, labels, stiffness_n_per_m, width_m, length_m, positions_m, period_s, force_n):
    """The same for every position of a path."""
    for i in range(positions_m.shape[0]):
        x, y, z = positions_m[i, 0], positions_m[i, 1], positions_m[i, 2]
        vx, vy, vz = step_velocity(positions_m, period_s, i)
        force_n[i, 0], force_n[i, 1], force_n[i, 2] = tick(
            height_m, normal, labels, stiffness_n_per_m, width_m, length_m, x, y, z, vx, vy, vz
        )
