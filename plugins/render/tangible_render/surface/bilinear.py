"""The cell under a point, and the bilinear height there; imports numba: import it inside a verb."""

import numpy as np
from numba import float64, int32, types, uint8

from tangible_core.compiled import KERNEL, inner, njit

HEIGHTS = types.Array(types.float32, 2, "C", readonly=True)
LABELS = types.Array(int32, 2, "C", readonly=True)
GREYS = types.Array(uint8, 2, "C", readonly=True)
TABLE = types.Array(float64, 1, "C", readonly=True)
NEWTONS = types.UniTuple(float64, 3)


@njit(**KERNEL)
def over(width_m, length_m, x, y):
    """Return True if a point is over the extent, its edge included; False for NaN."""
    return abs(x) <= 0.5 * width_m and abs(y) <= 0.5 * length_m


@njit(**KERNEL)
def cell(rows, columns, width_m, length_m, x, y):
    """Return (row, column) of the cell under a point over the extent."""
    # Cells are areas: a grid of h x w cells covers the extent, and row 0 is far (the greatest y).
    row = int(0.5 * rows - y * (rows / length_m))
    column = int(0.5 * columns + x * (columns / width_m))
    return min(row, rows - 1), min(column, columns - 1)


@njit(**KERNEL)
def bilinear(height_m, width_m, length_m, x, y):
    """Return height and exact gradient (h, dh/dx, dh/dy) of the bilinear interpolant between the cells' centres."""
    rows, columns = height_m.shape
    # From the outermost centres to the edge the heights continue unchanged, so that the slope across it is 0.
    left, right, across = _between(x * (columns / width_m) + 0.5 * (columns - 1), columns)
    far, near, down = _between(0.5 * (rows - 1) - y * (rows / length_m), rows)
    far_left, far_right = np.float64(height_m[far, left]), np.float64(height_m[far, right])
    near_left, near_right = np.float64(height_m[near, left]), np.float64(height_m[near, right])
    far_slope, near_slope = far_right - far_left, near_right - near_left
    far_height, near_height = far_left + across * far_slope, near_left + across * near_slope
    return (
        far_height + down * (near_height - far_height),
        (far_slope + down * (near_slope - far_slope)) * (columns / width_m),
        (far_height - near_height) * (rows / length_m),
    )


@inner()
def _between(place, count):
    last = count - 1
    if place <= 0.0:
        return 0, 0, 0.0
    if place >= last:
        return last, last, 0.0
    low = int(place)
    return low, low + 1, place - low
