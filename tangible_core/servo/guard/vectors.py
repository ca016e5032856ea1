"""Vectors of any floats, infinite and NaN included, compiled. Imports numba."""

# pyright: basic

import numpy as np

from ...compiled.compiling import inner


@inner(forceinline=True)
def zero_or_nan(x, y, z):
    """Return 0.0, or NaN if one of the three is not finite; a sum of such values never overflows."""
    return 0.0 * x + 0.0 * y + 0.0 * z


@inner(forceinline=True)
def clip(x, y, z, most):
    """Return the vector, clipped to this length, and whether it was longer; NaN where it is not finite."""
    if x * x + y * y + z * z <= most * most:
        return x, y, z, False
    greatest = max(abs(x), abs(y), abs(z))  # divided by first, so that the length cannot overflow
    x, y, z = x / greatest, y / greatest, z / greatest
    scale = most / np.sqrt(x * x + y * y + z * z)
    return scale * x, scale * y, scale * z, True
