"""The cushion's kernel. Imports numba: the law imports this module inside `touch`."""

import numpy as np
from numba import float64, njit, types

from tangible_core.compiled import KERNEL

HEIGHTS = types.Array(types.float32, 2, "C")
NEWTONS = types.UniTuple(float64, 3)


@njit(NEWTONS(HEIGHTS, *[float64] * 4, *[float64] * 6), **KERNEL)
def tick(height_m, width_m, length_m, stiffness_n_per_m, soft_m, x, y, z, vx, vy, vz):
    """Return a force straight up where the tip is below the surface; zero in free air and beyond the picture."""
    across, down = x / width_m + 0.5, 0.5 - y / length_m
    if not (0.0 <= across <= 1.0 and 0.0 <= down <= 1.0):
        return 0.0, 0.0, 0.0
    rows, columns = height_m.shape
    row, column = 0.5 + down * (rows - 2), 0.5 + across * (columns - 2)
    i, j = int(row), int(column)
    far = height_m[i, j] + (column - j) * (height_m[i, j + 1] - height_m[i, j])
    near = height_m[i + 1, j] + (column - j) * (height_m[i + 1, j + 1] - height_m[i + 1, j])
    depth = far + (row - i) * (near - far) - z
    soft = min(depth, soft_m)
    push = stiffness_n_per_m * (depth - soft + 0.5 * soft * soft / soft_m)
    return (0.0, 0.0, push) if depth > 0.0 and np.isfinite(push) else (0.0, 0.0, 0.0)
