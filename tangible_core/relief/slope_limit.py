"""The slope limit: a surface near to given heights that is nowhere steeper than a slope."""

from typing import Any, cast

import numpy as np
from jaxtyping import Float32

CHAMFER = 1.0276
"""The greatest ratio of a chamfer length, by steps to (0, 1), (1, 1) and (1, 2), to the straight one."""


def limit_slopes(height_m: Float32[np.ndarray, "h w"], pitch_m: float, slope: float) -> Float32[np.ndarray, "h w"]:
    """Return the heights with no rise over run above `slope` along rows, columns and diagonals; 0 keeps them."""
    if not slope:
        return height_m
    # A step of height s becomes a ramp s / slope wide about its middle. Limiting twice is limiting once; two maps that
    # differ by at most e still do so; mirrored or negated heights give the mirrored or negated surface. Distances are
    # chamfer lengths, at most 2.8 % over the straight ones (Borgefors 1986).
    steps = _between_envelopes(height_m, pitch_m, 2 * slope)  # a step is a ramp of `slope` now, a ridge may be steeper
    return _between_envelopes(steps, pitch_m, slope)


def _between_envelopes(
    height_m: Float32[np.ndarray, "h w"], pitch_m: float, slope: float
) -> Float32[np.ndarray, "h w"]:
    """Return the mean of the highest such surface that is nowhere above the heights, and the lowest nowhere below."""
    from . import slope_kernels

    # Of all surfaces that keep the slope, it has the least greatest error (McShane 1934; Whitney 1934). A step has half
    # of the slope, as only one of both envelopes rises at a place.
    envelopes = np.stack([height_m, -height_m])  # the upper envelope is the lower one upside down
    rise = slope * pitch_m / CHAMFER
    lengths = (np.float32(rise * length) for length in (1, 2**0.5, 5**0.5))
    cast(Any, slope_kernels).lower(envelopes, *lengths)
    return (envelopes[0] - envelopes[1]) * np.float32(0.5)
