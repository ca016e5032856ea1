"""Height and slope of a grid of cells between the cells' centres."""

import numpy as np
from jaxtyping import Float32, Float64
from numpy.typing import ArrayLike

from ..errors import ArgumentError
from .arguments import as_array

Numbers = Float64[np.ndarray, "..."]


def bilinear(
    height_m: Float32[np.ndarray, "h w"], extent_m: tuple[float, float], x_m: ArrayLike, y_m: ArrayLike
) -> tuple[Numbers, Numbers, Numbers]:
    """Return height and exact gradient (h, dh/dx, dh/dy) of the bilinear interpolant between the cells' centres.

    x_m, y_m: points in metres from the centre, x to the right, y away from the user; the results have their common
    shape, and are NaN beyond the extent. From the outermost centres to the edge the heights continue unchanged, as the
    force laws have it.
    Raises: ArgumentError for values that are not numbers, and for shapes that do not go together.
    """
    x_m, y_m = as_array("x_m", x_m, "float64"), as_array("y_m", y_m, "float64")
    try:
        both = np.broadcast_arrays(x_m, y_m)
    except ValueError as error:
        raise ArgumentError(f"x_m and y_m: shapes {x_m.shape} and {y_m.shape} do not go together") from error
    x, y = (np.ravel(each) for each in both)
    (rows, columns), (width_m, length_m) = height_m.shape, extent_m
    left, right, across = _between(x * (columns / width_m) + 0.5 * (columns - 1), columns)
    far, near, down = _between(0.5 * (rows - 1) - y * (rows / length_m), rows)
    far_left, far_right = height_m[far, left].astype(np.float64), height_m[far, right].astype(np.float64)
    near_left, near_right = height_m[near, left].astype(np.float64), height_m[near, right].astype(np.float64)
    far_slope, near_slope = far_right - far_left, near_right - near_left
    far_height, near_height = far_left + across * far_slope, near_left + across * near_slope
    over = (np.abs(x) <= 0.5 * width_m) & (np.abs(y) <= 0.5 * length_m)
    found = (
        far_height + down * (near_height - far_height),
        (far_slope + down * (near_slope - far_slope)) * (columns / width_m),
        (far_height - near_height) * (rows / length_m),
    )
    height, across_slope, along_slope = (np.where(over, each, np.nan).reshape(both[0].shape) for each in found)
    return height, across_slope, along_slope


def _between(place: Float64[np.ndarray, "n"], count: int) -> tuple[np.ndarray, np.ndarray, Float64[np.ndarray, "n"]]:
    """Return the two centres around each place, and its position between them, 0..1."""
    inside = np.clip(np.nan_to_num(place), 0, count - 1)
    low = inside.astype(np.intp)
    return low, low + ((inside > 0) & (inside < count - 1)), inside - low
