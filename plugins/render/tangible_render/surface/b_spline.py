"""The recursive filter that turns values into the coefficients of a cubic B-spline."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float64

POLE = -0.267949192431122706472553658494127633
"""Pole of the cubic B-spline's filter, sqrt(3) - 2. Source: Unser, Aldroubi & Eden (1993), see `coefficients`."""
GAIN = (1 - POLE) * (1 - 1 / POLE)
"""Factor on every value, 6 but for rounding: the filter leaves a constant as it is."""


def spline_filter(values: Float64[np.ndarray, "h w"]) -> None:
    """Replace each column's values by the coefficients of the cubic B-spline through them, in place.

    values: 3 rows or more, finite; beyond the outermost rows they go on as their mirror image.
    The same bits as SciPy's `spline_filter1d(values, 3, axis=0, mode="mirror")`, without the import of `scipy.ndimage`,
    which takes longer than the filter itself on any surface that one touches.
    """
    values *= GAIN
    rows, last, part = [*values], len(values) - 1, np.empty_like(values[0])
    across, weight = POLE**last, POLE
    rows[0] += across * rows[last]
    for row in range(1, last):
        np.multiply(rows[last - row], across, out=part)
        part += rows[row]
        part *= weight
        rows[0] += part
        weight *= POLE
        if not weight:  # too small for a double: all further ones are as well
            break
    rows[0] /= 1 - across * across
    for before, here in pairwise(rows):
        np.multiply(before, POLE, out=part)
        here += part
    rows[last][:] = (POLE * rows[last - 1] + rows[last]) * POLE / (POLE * POLE - 1)
    for after, here in zip(rows[:0:-1], rows[-2::-1], strict=True):
        np.subtract(after, here, out=here)
        here *= POLE
