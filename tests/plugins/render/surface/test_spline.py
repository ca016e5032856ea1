"""The surface would have wrong heights or slopes: against SciPy's natural cubic spline, and planes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from tangible_core.data import HapticSurface, Relief
from tangible_core.testing.synthetic.scenes import ramp
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_surface

RNG = np.random.default_rng(11)
HEIGHTS = (0.005 + 0.005 * np.sin(0.6 * np.arange(9)[:, None]) * np.cos(0.7 * np.arange(14) + 0.4)).astype(np.float32)
EXTENT = (0.07, 0.03)  # cells that are not square


def read(heights: np.ndarray, x: float, y: float, extent=EXTENT) -> tuple[float, ...]:
    """Return height, gradient and Hessian from one call."""
    coefficients, _, _, across, down = spline_surface(HapticSurface(Relief(heights, extent)), "never")
    return spline.bend(coefficients, across, down, x, y)


def peer(heights: np.ndarray, x: float, y: float) -> tuple[float, ...]:
    (rows, columns), (width, length) = heights.shape, EXTENT
    at_y = length / 2 - (np.arange(rows) + 0.5) * length / rows
    at_x = (np.arange(columns) + 0.5) * width / columns - width / 2

    def value(along: int, across: int) -> float:
        line = CubicSpline(at_y[::-1], heights[::-1].astype(float), bc_type="natural")(y, along)
        return float(CubicSpline(at_x, line, bc_type="natural")(x, across))

    return tuple(value(a, b) for a, b in ((0, 0), (0, 1), (1, 0), (0, 2), (1, 1), (2, 0)))


@given(st.floats(-1, 1), st.floats(-1, 1))
def test_surface_is_the_natural_cubic_spline(u: float, v: float):
    x, y = u * (0.07 - 0.005) / 2, v * (0.03 - 0.03 / 9) / 2  # between the outermost centres
    found, expected = read(HEIGHTS, x, y), peer(HEIGHTS, x, y)
    assert np.allclose(found, expected, rtol=0, atol=np.array([2e-9, 2e-6, 2e-6, 3e-3, 3e-3, 3e-3]))


def test_height_slope_and_bend_agree():
    coefficients, _, _, across, down = spline_surface(HapticSurface(Relief(HEIGHTS, EXTENT)), "never")
    for x, y in RNG.uniform(-0.5, 0.5, (200, 2)) * EXTENT:
        whole = spline.bend(coefficients, across, down, x, y)
        assert spline.slope(coefficients, across, down, x, y) == whole[:3]
        assert spline.height(coefficients, across, down, x, y) == whole[0]


@pytest.mark.parametrize("shape", [(65, 65), (3, 7), (2, 2), (7, 1)])
def test_plane_is_exact_up_to_its_border(shape: tuple[int, int]):
    known = ramp((0.0 if shape[1] == 1 else 0.2, 0.1), 0.05, shape)
    for x, y in (*RNG.uniform(-0.5, 0.5, (50, 2)), (0.5, 0.5), (-0.5, 0.5), (0.5, -0.5)):
        x, y = x * known.surface.extent_m[0], y * known.surface.extent_m[1]
        found = read(known.surface.height_m, x, y, known.surface.extent_m)
        assert np.allclose(found[:3], (known.height_m(x, y), *known.slope(x, y)), rtol=0, atol=1e-5)
        assert np.abs(found[3:]).max() < 0.05


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (5, 1)])
def test_smallest_grids_are_level(shape: tuple[int, int]):
    for x, y in ((0.0, 0.0), (0.035, -0.015), (-0.035, 0.015), (0.01, 0.01)):
        assert read(np.full(shape, 0.25, np.float32), x, y) == pytest.approx((0.25, 0, 0, 0, 0, 0), abs=1e-12)
