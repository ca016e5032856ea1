"""A ball that rolls over a surface: how high its lowest point lies, which is where a blunt fingertip can be."""

from collections.abc import Iterator
from itertools import product

import numpy as np
from jaxtyping import Float32


def roll_ball(
    height_m: Float32[np.ndarray, "h w"], extent_m: tuple[float, float], radius_m: float
) -> Float32[np.ndarray, "h w"]:
    """Return the height of the lowest point of a ball that lies on the surface, at each cell (the offset surface).

    h_r(x) = max over |d| <= r of h(x + d) + sqrt(r^2 - |d|^2) - r: a dilation by the ball. The radius of curvature of
    every bump grows by r, and a groove narrower than 2 r is shallower or gone. Beyond the border there is no surface.
    The ball may touch cells' centres and the middles between them, where heights are means. On slopes of s, h_r is too
    low by up to cell^2 ((1 + s^2)^(3/2) / r + 5 curvature) / 32.
    extent_m: width and length. radius_m: not negative; 0 returns the heights.
    Source: Serra, Image Analysis and Mathematical Morphology (1982), the dilation of a function by a ball.
    """
    if radius_m == 0:
        return height_m
    (rows, columns), (width_m, length_m) = height_m.shape, extent_m
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
    """Return the heights, or with `half` those in the middle between each row and the next."""
    return (height_m[:-1] + height_m[1:]) / 2 if half else height_m


def _steps(half: int, reach_m: float, cell_m: float, cells: int) -> Iterator[tuple[int, float]]:
    """Yield the shifts, in whole cells, to places within reach, each with its distance."""
    whole = min(cells - 1, int(reach_m / cell_m) + 1)
    for shift in range(-whole, whole + 1 - half):
        if abs(distance_m := (shift + half / 2) * cell_m) <= reach_m:
            yield shift, distance_m


def _overlap(shift: int, cells: int, half: int) -> tuple[slice, slice]:
    """Return the cells that have a place at this shift, and the places."""
    first, last = max(0, -shift), min(cells, cells - half - shift)
    return slice(first, last), slice(first + shift, last + shift)
