"""The surface would have wrong heights or slopes, or steps of 8 bits would be felt."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from scipy.ndimage import spline_filter1d

from tangible_core.data import HapticSurface, Relief
from tangible_core.testing.synthetic.scenes import plane, ramp, sphere_cap, waves
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_filter, spline_surface
from tangible_render.surface.dequantise import dequantise, lattice_step

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


@pytest.mark.parametrize("shape", [(3, 5), (4, 1), (64, 90), (700, 30)])
def test_spline_filter_gives_the_same_bits_as_scipy(shape: tuple[int, int]):
    draw = np.random.default_rng(3)
    values = draw.normal(size=shape) * 10.0 ** draw.integers(-6, 3, shape)
    filtered = values.copy()
    spline_filter(filtered)
    assert (filtered == spline_filter1d(values, order=3, axis=0, mode="mirror")).all()


NOISE = np.random.default_rng(5)
STEP_M = 0.008 / 255


def in_steps(height_m: np.ndarray, count: int = 255) -> np.ndarray:
    highest = float(height_m.max())
    return np.asarray(np.rint(height_m / highest * count) / count * highest, np.float32)


def off_the_normal(known, heights: np.ndarray, cells) -> np.ndarray:
    """Return degrees between the surface's normals and the true ones, 2 mm inside the border."""
    coefficients, _, _, across, down = spline_surface(HapticSurface.from_heights(heights), cells)
    angles = []
    for x, y in np.random.default_rng(1).uniform(-0.038, 0.038, (3000, 2)):
        _, sx, sy = spline.slope(coefficients, across, down, x, y)
        normal = np.array([-sx, -sy, 1]) / np.sqrt(1 + sx * sx + sy * sy)
        angles.append(np.degrees(np.arccos(min(1.0, normal @ known.normal(x, y)))))
    return np.array(angles)


def test_waves_of_8_bits_are_smooth_and_move_by_half_a_step():
    known = waves(shape=(256, 256))
    heights = in_steps(known.surface.height_m)
    assert np.percentile(off_the_normal(known, heights, "auto"), 99) < 0.5
    assert np.percentile(off_the_normal(known, heights, "never"), 99) > 1.5
    assert dequantise(heights, "never") is heights
    assert not np.array_equal(dequantise(heights, 2.0), dequantise(heights, 4.0))
    for heights in (in_steps(waves().surface.height_m), in_steps(NOISE.uniform(0, 0.008, (60, 80)))):
        moved = np.abs(dequantise(heights).astype(float) - heights)
        assert 0.1 < moved.max() / STEP_M <= 0.5 + 1e-4
    heights = np.linspace(0, 0.002, 200)[None, :] + 0.006 * (np.arange(200) >= 100)[None, :] + np.zeros((50, 1))
    found = dequantise(in_steps(heights))
    assert (found[:, 100] - found[:, 99] > 0.0059).all()


@pytest.mark.parametrize("known", [plane(), ramp(), sphere_cap()], ids=["plane", "ramp", "sphere"])
def test_surface_without_steps_stays(known):
    heights = known.surface.height_m
    assert np.allclose(dequantise(heights), heights, rtol=0, atol=2e-8)


@pytest.mark.parametrize(
    "heights",
    [
        np.zeros((1, 1)),
        np.array([[0.0, 0.01]]),
        np.repeat([[0.0, 0.001, 0.002, 0.003]], 4, axis=0),
        NOISE.uniform(0, 0.01, (12, 20)),
        in_steps(NOISE.uniform(0, 0.01, (40, 40)), 1000),
        NOISE.uniform(0, 0.01, (300, 300)),
    ],
)
def test_terraces_and_fine_heights_stay(heights: np.ndarray):
    heights = np.asarray(heights, np.float32)
    assert lattice_step(heights) == 0
    assert dequantise(heights) is heights
