"""The C2 surface: against a natural cubic spline of another make, on planes, and on the smallest grids."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from tangible_core.data import HapticSurface, Relief
from tangible_core.testing.synthetic.scenes import ramp
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_coefficients, spline_surface

RNG = np.random.default_rng(11)
HEIGHTS = (0.005 + 0.005 * np.sin(0.6 * np.arange(9)[:, None]) * np.cos(0.7 * np.arange(14) + 0.4)).astype(np.float32)
EXTENT = (0.07, 0.03)  # cells that are not square


def read(heights: np.ndarray, x: float, y: float, extent=EXTENT) -> tuple[float, ...]:
    """Height, gradient and Hessian, by the function that gives all of them."""
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
def test_it_is_the_natural_cubic_spline(u: float, v: float):
    x, y = u * (0.07 - 0.005) / 2, v * (0.03 - 0.03 / 9) / 2  # between the outermost centres
    found, expected = read(HEIGHTS, x, y), peer(HEIGHTS, x, y)
    assert np.allclose(found, expected, rtol=0, atol=np.array([2e-9, 2e-6, 2e-6, 3e-3, 3e-3, 3e-3]))


def test_the_three_readings_agree():
    coefficients, _, _, across, down = spline_surface(HapticSurface(Relief(HEIGHTS, EXTENT)), "never")
    for x, y in RNG.uniform(-0.5, 0.5, (200, 2)) * EXTENT:
        whole = spline.bend(coefficients, across, down, x, y)
        assert spline.slope(coefficients, across, down, x, y) == whole[:3]
        assert spline.height(coefficients, across, down, x, y) == whole[0]


@pytest.mark.parametrize("shape", [(65, 65), (3, 7), (2, 2), (7, 1)])
def test_a_plane_is_that_plane_up_to_its_border(shape: tuple[int, int]):
    known = ramp((0.0 if shape[1] == 1 else 0.2, 0.1), 0.05, shape)
    for x, y in (*RNG.uniform(-0.5, 0.5, (50, 2)), (0.5, 0.5), (-0.5, 0.5), (0.5, -0.5)):
        x, y = x * known.surface.extent_m[0], y * known.surface.extent_m[1]
        found = read(known.surface.height_m, x, y, known.surface.extent_m)
        assert np.allclose(found[:3], (known.height_m(x, y), *known.slope(x, y)), rtol=0, atol=1e-5)
        assert np.abs(found[3:]).max() < 0.05


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (5, 1)])
def test_the_smallest_grids_are_level(shape: tuple[int, int]):
    for x, y in ((0.0, 0.0), (0.035, -0.015), (-0.035, 0.015), (0.01, 0.01)):
        assert read(np.full(shape, 0.25, np.float32), x, y) == pytest.approx((0.25, 0, 0, 0, 0, 0), abs=1e-12)


def test_height_slope_and_curvature_are_continuous_across_cells():
    for row in range(9):
        y = EXTENT[1] / 2 - (row + 0.5) * EXTENT[1] / 9  # a line of knots
        for x in RNG.uniform(-0.03, 0.03, 20):
            above, below = read(HEIGHTS, x, y + 1e-12), read(HEIGHTS, x, y - 1e-12)
            assert np.allclose(above, below, rtol=1e-6, atol=1e-4)


def test_float32_coefficients_and_their_margin():
    found = spline_coefficients(HEIGHTS)
    assert found.dtype == np.float32 and found.shape == (13, 18) and found.flags.c_contiguous
    assert np.isinf(spline_coefficients(np.array([[0, 3e38, 0]], np.float32))).any()  # no warning, no exception


def test_what_is_asked_for_ahead_is_what_is_read(monkeypatch: pytest.MonkeyPatch):
    coefficients, _, _, across, down = spline_surface(HapticSurface(Relief(HEIGHTS, EXTENT)), "never")
    spline.height(coefficients, across, down, 0.0, 0.0)  # compiled before its parts are exchanged
    asked: list[tuple[int, int]] = []
    monkeypatch.setattr(spline, "_shape", np.shape)
    monkeypatch.setattr(spline, "_fetch", lambda _, row, column: asked.append((row, column)))
    for x, y in (*(RNG.uniform(-0.49, 0.49, (20, 2)) * EXTENT).tolist(), (0.035, -0.015), (-0.035, 0.015)):
        asked.clear()
        spline.prefetch(coefficients, across, down, x, y)
        height, read = spline.height(coefficients, across, down, x, y), set[int]()
        for index in np.ndindex(coefficients.shape):
            other = coefficients.copy()
            other[index] += 1
            if spline.height(other, across, down, x, y) != height:
                read.add(index[0])
                assert index[1] in range(min(asked)[1], max(asked)[1] + 1)
        assert read <= {row for row, _ in asked} and len(asked) == 8
