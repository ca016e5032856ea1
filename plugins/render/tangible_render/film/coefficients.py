"""Coefficients of a surface within milliseconds: those of a still one, by finite filters instead of recursive ones."""

import numpy as np
from jaxtyping import Float32

from ..surface.coefficients import spline_coefficients
from ..surface.jumps import ROUNDING
from .scratch import MARGIN, TAPS, Scratch

HIGHEST_M = 1e6
"""Heights above count as this: numbers of which float32 can take differences, and no hand comes there."""


def quick_coefficients(height_m: Float32[np.ndarray, "h w"], scratch: Scratch) -> Float32[np.ndarray, "h4 w4"]:
    """As `spline_coefficients`, within a hundred-thousandth of the heights: jumps are found and eased as there.

    Where that filters by recursion in float64, this does by 21 taps in float32; grids too small for these are done as
    there. The array is the scratch's own. The same bits on every processor.
    Source: Unser, Aldroubi & Eden, B-spline signal processing, IEEE Trans. Signal Processing 41 (1993), sec. II-B.
    """
    height_m, highest_m = np.ascontiguousarray(height_m), height_m.max()
    if highest_m > HIGHEST_M:
        height_m, highest_m = np.minimum(height_m, np.float32(HIGHEST_M)), np.float32(HIGHEST_M)
    if min(height_m.shape) <= MARGIN:
        return spline_coefficients(height_m)
    from .filter_kernels import filter_coefficients, mark_jumps

    mark_jumps(height_m, highest_m * ROUNDING, *scratch[:3])
    filter_coefficients(height_m, scratch.near, _taps(), scratch.values, scratch.eased, scratch.coefficients)
    return scratch.coefficients


def _taps() -> Float32[np.ndarray, "t"]:
    """What a height weighs in the coefficient of its own cell, and in those of the ones beside it; in all 1."""
    weights = (np.sqrt(3) - 2) ** np.arange(TAPS + 1)
    return np.asarray(weights / (2 * weights.sum() - 1), np.float32)
