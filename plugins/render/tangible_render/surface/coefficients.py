"""Coefficients of a C2 surface, a cubic B-spline through the heights except near jumps, and its bounds by tiles."""

from collections.abc import Callable, Iterator
from itertools import pairwise, product

import numpy as np
from jaxtyping import Bool, Float32, Float64

from tangible_core.data import HapticSurface

from .dequantise import Filter, dequantise
from .jumps import ease, jumps

# The rows and columns of coefficients beyond the heights on each side, for the outermost half cell.
BORDER = 2
# The cells added for the recursive filter: the effect of its start has faded by (2 - sqrt 3)^32, 1e-18.
_RUN_IN = 32
# Pole of the cubic B-spline's filter, sqrt(3) - 2. Source: Unser, Aldroubi & Eden (1993), as below.
POLE = -0.267949192431122706472553658494127633
# Factor on every value, 6 but for rounding: the filter leaves a constant as it is.
GAIN = (1 - POLE) * (1 - 1 / POLE)


def spline_coefficients(height_m: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h4 w4"]:
    """Compute coefficients (h + 4, w + 4) of the cubic B-spline with these heights at the cells' centres."""
    at = jumps(height_m)
    # Beyond the outermost centres the heights continue as their odd reflection, 2 h(0) - h(-x): a plane stays that
    # plane up to the border, and the curvature there is 0 (a natural spline). At jumps, where it would overshoot by a
    # tenth of a step or more, the spline leaves the heights: it joins both sides without a groove at the foot or a lip
    # at the top, and goes on level beyond the border. Source: Unser, Aldroubi & Eden, B-spline signal processing, IEEE
    # Trans. Signal Processing 41 (1993).
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


def spline_filter(values: Float64[np.ndarray, "h w"]) -> None:
    """Replace each column's values, 3 or more, by the coefficients of the cubic B-spline through them, in place."""
    # The bits of SciPy's `spline_filter1d(values, 3, axis=0, mode="mirror")`, without the import of `scipy.ndimage`,
    # which takes longer than the filter itself on any surface that one touches.
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


def spline_surface(
    surface: HapticSurface, cells: Filter, radius_m: float = 0.0
) -> tuple[Float32[np.ndarray, "h4 w4"], float, float, float, float]:
    """Return a kernel's arguments: coefficients, width and length in m, and cells per metre along x and y."""
    (rows, columns), (width_m, length_m) = surface.height_m.shape, surface.extent_m
    height_m = roll_ball(dequantise(surface.height_m, cells), surface.extent_m, radius_m)
    return spline_coefficients(height_m), float(width_m), float(length_m), columns / width_m, rows / length_m


def roll_ball(
    height_m: Float32[np.ndarray, "h w"], extent_m: tuple[float, float], radius_m: float
) -> Float32[np.ndarray, "h w"]:
    """Return the height of the lowest point of a ball that lies on the surface, at each cell (the offset surface)."""
    if radius_m == 0:
        return height_m
    (rows, columns), (width_m, length_m) = height_m.shape, extent_m
    # h_r(x) = max over |d| <= r of h(x + d) + sqrt(r^2 - |d|^2) - r: a dilation by the ball (Serra, Image Analysis and
    # Mathematical Morphology, 1982). The radius of curvature of every bump grows by r, and a groove narrower than 2 r
    # is shallower or gone. The ball may touch cells' centres and the middles between them; on slopes of s, h_r is too
    # low by up to cell^2 ((1 + s^2)^(3/2) / r + 5 curvature) / 32.
    rolled = height_m.copy()
    for beside, beneath in product((0, 1), (0, 1)):  # half cells
        touched_m = _means(_means(height_m, beneath).T, beside).T
        for dy, dy_m in _steps(beneath, radius_m, length_m / rows, rows):
            across_m = (radius_m**2 - dy_m**2) ** 0.5
            for dx, dx_m in _steps(beside, across_m, width_m / columns, columns):
                lift_m = np.float32((across_m**2 - dx_m**2) ** 0.5 - radius_m)
                (to_y, from_y), (to_x, from_x) = _overlap(dy, rows, beneath), _overlap(dx, columns, beside)
                there = rolled[to_y, to_x]
                np.maximum(there, touched_m[from_y, from_x] + lift_m, out=there)
    return rolled


def _means(height_m: Float32[np.ndarray, "n m"], half: int) -> Float32[np.ndarray, "k m"]:
    return (height_m[:-1] + height_m[1:]) / 2 if half else height_m


def _steps(half: int, reach_m: float, cell_m: float, cells: int) -> Iterator[tuple[int, float]]:
    """Yield the shifts, in whole cells, to places within reach, each with its distance."""
    whole = min(cells - 1, int(reach_m / cell_m) + 1)
    for shift in range(-whole, whole + 1 - half):
        if abs(distance_m := (shift + half / 2) * cell_m) <= reach_m:
            yield shift, distance_m


def _overlap(shift: int, cells: int, half: int) -> tuple[slice, slice]:
    first, last = max(0, -shift), min(cells, cells - half - shift)
    return slice(first, last), slice(first + shift, last + shift)


TILE_CELLS = 16
MAX_TILES = 256  # the largest number of tiles along a side; larger grids have larger tiles


def tile_bounds(coefficients: Float32[np.ndarray, "h4 w4"]) -> Float32[np.ndarray, "r c 2"]:
    """Compute an upper and a lower bound of the surface over each of r x c equal tiles: of 16 cells, or 256 a side."""
    # A B-spline is nowhere above the greatest of its 4 x 4 coefficients, nor below the least: its weights are positive
    # and sum to 1. Where both bounds of a tile are equal, the surface is level.
    highest, lowest = coefficients, coefficients
    for axis in (0, 1):
        highest, lowest = _reduce(np.max, highest, axis), _reduce(np.min, lowest, axis)
    return np.ascontiguousarray(np.stack([highest, lowest], axis=2))


def _reduce(extreme: Callable[..., np.ndarray], values: np.ndarray, axis: int) -> np.ndarray:
    """Return one value for each tile along this axis, over all coefficients of the points in it and at its edge."""
    lines = np.moveaxis(values, axis, 0)
    cells = len(lines) - 2 * BORDER
    count = min(-(-cells // TILE_CELLS), MAX_TILES)
    edges = np.floor(np.arange(count + 1) * cells / count).astype(int) + BORDER
    return np.moveaxis(np.stack([extreme(lines[max(a - 3, 0) : b + 4], axis=0) for a, b in pairwise(edges)]), 0, axis)
