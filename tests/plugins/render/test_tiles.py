"""Bounds of a surface, tile by tile."""

import numpy as np
import pytest

from tangible_core.data import HapticSurface, Relief
from tangible_render import spline
from tangible_render.bilinear import cell
from tangible_render.coefficients import spline_surface
from tangible_render.tiles import tile_bounds

RNG = np.random.default_rng(2)


@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (16, 16), (17, 33), (50, 70), (2, 1100)])
def test_every_place_lies_between_the_bounds_of_its_tile(shape: tuple[int, int]):
    surface = HapticSurface(Relief(RNG.uniform(0, 0.01, shape).astype(np.float32), (0.08, 0.05)))
    coefficients, width, length, across, down = spline_surface(surface, "never")
    bounds = tile_bounds(coefficients)
    rows, columns, _ = bounds.shape
    assert (rows, columns) == (-(-shape[0] // 16), min(64, -(-shape[1] // 16)))
    edges = [
        (c * width / columns - width / 2, r * length / rows - length / 2)
        for c in range(columns + 1)
        for r in range(rows + 1)
    ]
    for x, y in (*(RNG.uniform(-0.5, 0.5, (300, 2)) * [width, length]), *edges):
        row, column = cell(rows, columns, width, length, x, y)
        highest, lowest = bounds[row, column]
        assert lowest - 1e-15 <= spline.height(coefficients, across, down, x, y) <= highest + 1e-15


def test_level_ground_has_equal_bounds_and_a_bump_has_not():
    heights = np.full((200, 200), 0.003, np.float32)
    heights[150, 150] = 0.004
    bounds = tile_bounds(spline_surface(HapticSurface.from_heights(heights), "auto")[0])
    level = bounds[..., 0] == bounds[..., 1]
    assert level[:6, :6].all() and not level[9:11, 9:11].any()
