"""A hand in a tile would not be pushed, as the tile's bounds say that it is in free air."""

import numpy as np
import pytest

from tangible_core.data import HapticSurface, Relief
from tangible_render.surface import spline
from tangible_render.surface.bilinear import cell
from tangible_render.surface.coefficients import spline_surface, tile_bounds

RNG = np.random.default_rng(2)


@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (16, 16), (17, 33), (50, 70), (2, 4200)])
def test_places_lie_between_the_bounds_of_their_tile(shape: tuple[int, int]):
    surface = HapticSurface(Relief(RNG.uniform(0, 0.01, shape).astype(np.float32), (0.08, 0.05)))
    coefficients, width, length, across, down = spline_surface(surface, "never")
    bounds = tile_bounds(coefficients)
    rows, columns, _ = bounds.shape
    assert (rows, columns) == (-(-shape[0] // 16), min(256, -(-shape[1] // 16)))
    edges = [
        (c * width / columns - width / 2, r * length / rows - length / 2)
        for c in range(columns + 1)
        for r in range(rows + 1)
    ]
    for x, y in (*(RNG.uniform(-0.5, 0.5, (300, 2)) * [width, length]), *edges):
        row, column = cell(rows, columns, width, length, x, y)
        highest, lowest = bounds[row, column]
        assert lowest - 1e-15 <= spline.height(coefficients, across, down, x, y) <= highest + 1e-15


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("count", [40, 48])
@pytest.mark.parametrize("sign", [1, -1])
def test_coefficient_counts_in_every_tile_it_reaches(count: int, turned: bool, sign: int):
    """A coefficient that is not 0 raises or lowers the surface wherever it has a weight."""
    for line in range(count + 4):
        lines = np.zeros((count + 4, 5), np.float32)
        lines[line] = sign
        coefficients = np.ascontiguousarray(lines.T if turned else lines)
        bounds = tile_bounds(coefficients)
        for place in np.linspace(-0.5, 0.5, 12 * count + 1).tolist():
            at = (place, 0.0) if turned else (0.0, place)
            across, down = (count, 1) if turned else (1, count)
            highest, lowest = bounds[cell(*bounds.shape[:2], 1.0, 1.0, *at)]
            assert lowest <= spline.height(coefficients, float(across), float(down), *at) <= highest
