"""The compiled kernel of `tangible-mask`. Imports numba: the method imports this module inside `touch`."""

import numpy as np
from numba import float64, int64, types

from tangible_core.compiled import KERNEL, njit

from ..surface.bilinear import HEIGHTS, NEWTONS, cell, over

TABLES = types.Array(int64, 3, "C", readonly=True)
SURFACE = (HEIGHTS, TABLES, float64, float64, int64, int64, float64, float64)


@njit(types.UniTuple(int64, 2)(TABLES, *[int64] * 4), **KERNEL)
def window(tables, row, column, half_rows, half_columns):
    """Sum dark u and dark v over the mask around a cell, u along the columns and v against the rows."""
    far, near = row - half_rows, row + half_rows + 1
    left, right = column - half_columns, column + half_columns + 1
    dark = tables[near, right, 0] - tables[far, right, 0] - tables[near, left, 0] + tables[far, left, 0]
    across = tables[near, right, 1] - tables[far, right, 1] - tables[near, left, 1] + tables[far, left, 1]
    down = tables[near, right, 2] - tables[far, right, 2] - tables[near, left, 2] + tables[far, left, 2]
    return across - column * dark, row * dark - down


@njit(NEWTONS(*SURFACE, *[float64] * 6), **KERNEL)
def tick(height_m, tables, width_m, length_m, half_rows, half_columns, across_n, along_n, x, y, z, vx, vy, vz):
    """Compute (across_n sum dark u, along_n sum dark v, 0) below the surface; zero where the mask leaves it."""
    if not (over(width_m, length_m, x, y) and np.isfinite(z + vx + vy + vz)):
        return 0.0, 0.0, 0.0
    rows, columns = height_m.shape
    row, column = cell(rows, columns, width_m, length_m, x, y)
    inside = half_rows <= row < rows - half_rows and half_columns <= column < columns - half_columns
    if not inside or z >= np.float64(height_m[row, column]):
        return 0.0, 0.0, 0.0
    across, along = window(tables, row, column, half_rows, half_columns)
    return across_n * across, along_n * along, 0.0
