"""Vectors of any floats at all, compiled. Imports numba."""

# ruff: noqa: ANN001, ANN201 -- the types are those that numba infers
# pyright: basic

import numpy as np

from ...compiled.compiling import inner


@inner(forceinline=True)
def nought(x, y, z):
    """0.0, and NaN if one of them is not finite; no sum of these overflows."""
    return 0.0 * x + 0.0 * y + 0.0 * z


@inner(forceinline=True)
def shortened(x, y, z, most):
    """The vector in its direction, of at most this length, and whether it was over it; NaN where it is not finite."""
    if x * x + y * y + z * z <= most * most:
        return x, y, z, False
    greatest = max(abs(x), abs(y), abs(z))  # divided by first, so that the length cannot overflow
    x, y, z = x / greatest, y / greatest, z / greatest
    scale = most / np.sqrt(x * x + y * y + z * z)
    return scale * x, scale * y, scale * z, True
