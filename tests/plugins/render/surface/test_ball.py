"""A fingertip would sink into a groove it does not fit in, or not be pushed in a tile."""

import numpy as np
import pytest

from tangible_core.data import HapticState, HapticSurface, Relief
from tangible_core.errors import ConfigError
from tangible_render.proxy import Proxy
from tangible_render.surface import spline
from tangible_render.surface.bilinear import cell
from tangible_render.surface.coefficients import roll_ball, spline_surface, tile_bounds

WIDE_M = 0.04
CELLS = 300
"""Cells of 0.13 mm, as a picture 80 mm wide has."""
CELL_M = WIDE_M / CELLS
AT_M = (np.arange(CELLS) + 0.5) * CELL_M - WIDE_M / 2
EXTENT_M = (WIDE_M, WIDE_M)
RADII_M = (0.0005, 0.001)


def sheet(height_m: np.ndarray) -> np.ndarray:
    """Heights that depend on x alone, or on x and y."""
    return np.broadcast_to(height_m, (CELLS, CELLS)).astype(np.float32)


@pytest.mark.parametrize("length_m", [WIDE_M, 0.5 * WIDE_M])
@pytest.mark.parametrize("radius_m", RADII_M)
def test_ball_on_waves_lies_where_the_formula_says(radius_m: float, length_m: float):
    """Within the bound of the docstring, for the steepest slope, .63."""
    height_m, waves = 0.0004, 2 * np.pi / 0.004
    rolled = roll_ball(sheet(height_m * np.cos(waves * AT_M)), (WIDE_M, length_m), radius_m)
    way = np.linspace(-radius_m, radius_m, 20_001)
    inside = slice(40, 80)
    arc = np.sqrt(np.maximum(radius_m**2 - way**2, 0)) - radius_m
    exact = [(height_m * np.cos(waves * (x + way)) + arc).max() for x in AT_M[inside]]
    error = np.abs(rolled[150, inside] - exact).max()
    assert error < CELL_M**2 * (1.64 / radius_m + 5 * height_m * waves**2) / 32 + 1e-7
    assert np.abs(rolled - rolled[0]).max() < 1e-7
    assert np.array_equal(roll_ball(sheet(AT_M), EXTENT_M, 0.0), sheet(AT_M)), "without a radius it is a point"


def test_groove_narrower_than_the_ball_is_bridged():
    """A ball of 1 mm between walls 4 cells from the middle, 0.53 mm, sinks by r - sqrt(r^2 - 0.53^2), however deep."""
    groove = np.full(CELLS, 0.005)
    groove[146:153] = 0.0
    rolled = roll_ball(sheet(groove), EXTENT_M, 0.001)
    assert rolled[150, 149] == pytest.approx(0.005 - 0.001 + (0.001**2 - (4 * CELL_M) ** 2) ** 0.5, abs=1e-7)
    assert rolled[150, 149] == rolled[150].min()
    assert rolled[150, :146] == pytest.approx(0.005, abs=1e-7)


@pytest.mark.parametrize("radius_m", RADII_M)
def test_force_of_a_ball_on_a_sphere_is_that_of_the_larger_sphere(radius_m: float):
    """Two balls touch where their centres are R + r apart; the hand's place is the lowest point of the upper one."""
    large_m, down_m, k = 0.03, 0.01, 800.0
    y, x = np.meshgrid(-AT_M, AT_M, indexing="ij")
    cap = np.sqrt(large_m**2 - x**2 - y**2) - down_m
    touch = Proxy(stiffness_n_per_m=k, radius_m=radius_m).touch(HapticSurface(Relief(cap.astype(np.float32), EXTENT_M)))
    for place in ((0.0, 0.0), (0.004, -0.003), (-0.006, 0.001)):
        axis = np.array([*place, 0.0])
        axis[2] = np.sqrt((large_m + radius_m) ** 2 - axis @ axis)
        axis /= np.linalg.norm(axis)
        lowest = (large_m + radius_m - 0.001) * axis - [0, 0, down_m + radius_m]
        state = HapticState(tuple(map(float, lowest)), (0.0, 0.0, 0.0))
        touch.force(HapticState((float(lowest[0]), float(lowest[1]), 0.02), (0.0, 0.0, 0.0)))
        for _ in range(3):
            force = touch.force(state)
            assert np.array(force) == pytest.approx(k * 0.001 * axis, abs=0.01)
    with pytest.raises(ConfigError, match="leave out `radius_m`"):
        Proxy(radius_m=radius_m).film(HapticSurface.from_heights(cap))


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
