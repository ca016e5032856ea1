"""Heights as the coefficients of a C2 surface: a cubic B-spline through every cell's centre."""

import numpy as np
from jaxtyping import Float32

from tangible_core.data import HapticSurface

from .dequantise import Filter, dequantise

BORDER = 2
"""Rows and columns of coefficients beyond the heights on each side, which the outermost half cell needs."""
_RUN_IN = 32
"""Cells continued for the recursive filter: what it does at the very end has faded by (2 - sqrt 3)^32, 1e-18."""


def spline_coefficients(height_m: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h4 w4"]:
    """Coefficients (h + 4, w + 4) of the cubic B-spline that has these heights at the cells' centres.

    Beyond the outermost centres the heights go on as their odd reflection, 2 h(0) - h(-x): a plane stays that plane
    up to the border of the extent, and the curvature across the outermost centres is 0 (a natural spline).
    Source: Unser, Aldroubi & Eden, B-spline signal processing, IEEE Trans. Signal Processing 41 (1993).
    """
    from scipy.ndimage import spline_filter

    continued = np.pad(height_m.astype(np.float64), _RUN_IN, mode="reflect", reflect_type="odd")
    kept = slice(_RUN_IN - BORDER, BORDER - _RUN_IN)
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(spline_filter(continued, order=3, mode="mirror")[kept, kept], np.float32)


def spline_surface(
    surface: HapticSurface, cells: Filter
) -> tuple[Float32[np.ndarray, "h4 w4"], float, float, float, float]:
    """What kernels read: the coefficients, the width and length in metres, and the cells to the metre along x and y.

    Heights in steps are smoothed first, see `dequantise`.
    """
    (rows, columns), (width_m, length_m) = surface.height_m.shape, surface.extent_m
    coefficients = spline_coefficients(dequantise(surface.height_m, cells))
    return coefficients, float(width_m), float(length_m), columns / width_m, rows / length_m
