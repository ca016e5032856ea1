"""Coefficients of a C2 surface: a cubic B-spline through the heights at the cells' centres, except near jumps."""

import numpy as np
from jaxtyping import Bool, Float32, Float64

from tangible_core.data import HapticSurface

from .b_spline import spline_filter
from .ball import roll_ball
from .dequantise import Filter, dequantise
from .jumps import ease, jumps

BORDER = 2
"""The rows and columns of coefficients beyond the heights on each side, for the outermost half cell."""
_RUN_IN = 32
"""The cells added for the recursive filter: the effect of its start has faded by (2 - sqrt 3)^32, 1e-18."""


def spline_coefficients(height_m: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h4 w4"]:
    """Compute coefficients (h + 4, w + 4) of the cubic B-spline with these heights at the cells' centres.

    Beyond the outermost centres the heights continue as their odd reflection, 2 h(0) - h(-x): a plane stays that plane
    up to the border of the extent, and the curvature across the outermost centres is 0 (a natural spline).

    At jumps, where it would overshoot by a tenth of a step or more, the spline leaves the heights: it joins the two
    sides without a groove at the foot or a lip at the top, and continues level beyond the border.
    Source: Unser, Aldroubi & Eden, B-spline signal processing, IEEE Trans. Signal Processing 41 (1993).
    """
    at = jumps(height_m)
    values = _extend(height_m, at)
    near = np.pad(np.pad(at, BORDER, mode="edge"), _RUN_IN - BORDER)
    inside = slice(_RUN_IN - BORDER, BORDER - _RUN_IN)
    ease(values, near)
    spline_filter(values)
    values, near = np.ascontiguousarray(values.T), near.T
    ease(values, near)
    spline_filter(values)
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(values[inside, inside].T, np.float32)


def _extend(height_m: Float32[np.ndarray, "h w"], at: Bool[np.ndarray, "h w"]) -> Float64[np.ndarray, "h64 w64"]:
    """Extend heights beyond each border by their odd reflection, or level where they jump at the border."""
    heights = height_m.astype(np.float64)
    values = np.pad(heights, _RUN_IN, mode="reflect", reflect_type="odd")
    if at.any():
        np.copyto(values, np.pad(heights, _RUN_IN, mode="edge"), where=np.pad(at, _RUN_IN, mode="edge"))
    return values


def spline_surface(
    surface: HapticSurface, cells: Filter, radius_m: float = 0.0
) -> tuple[Float32[np.ndarray, "h4 w4"], float, float, float, float]:
    """Return a kernel's arguments: the coefficients, width and length in m, and cells per metre along x and y.

    Quantised heights are smoothed first, see `dequantise`. radius_m: of a ball that rolls over them, see `roll_ball`.
    """
    (rows, columns), (width_m, length_m) = surface.height_m.shape, surface.extent_m
    height_m = roll_ball(dequantise(surface.height_m, cells), surface.extent_m, radius_m)
    return spline_coefficients(height_m), float(width_m), float(length_m), columns / width_m, rows / length_m
