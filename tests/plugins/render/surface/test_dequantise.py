"""Steps of 8 bit heights would be felt, or real terraces would be smoothed away."""

import numpy as np
import pytest

from tangible_core.data import HapticSurface
from tangible_core.testing.synthetic.scenes import plane, ramp, sphere_cap, waves
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_surface
from tangible_render.surface.dequantise import dequantise, lattice_step

RNG = np.random.default_rng(5)
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


def test_waves_of_8_bits_are_smooth_within_half_a_degree():
    known = waves(shape=(256, 256))
    heights = in_steps(known.surface.height_m)
    assert np.percentile(off_the_normal(known, heights, "auto"), 99) < 0.5
    assert np.percentile(off_the_normal(known, heights, "never"), 99) > 1.5


def test_heights_move_by_at_most_half_a_step():
    for heights in (in_steps(waves().surface.height_m), in_steps(RNG.uniform(0, 0.008, (60, 80)))):
        moved = np.abs(dequantise(heights).astype(float) - heights)
        assert 0.1 < moved.max() / STEP_M <= 0.5 + 1e-4


def test_cliff_between_smooth_slopes_stays():
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
        RNG.uniform(0, 0.01, (12, 20)),
        in_steps(RNG.uniform(0, 0.01, (40, 40)), 1000),
        RNG.uniform(0, 0.01, (300, 300)),
    ],
)
def test_terraces_and_fine_heights_stay(heights: np.ndarray):
    heights = np.asarray(heights, np.float32)
    assert lattice_step(heights) == 0
    assert dequantise(heights) is heights


def test_never_leaves_heights_in_steps():
    heights = in_steps(waves(shape=(64, 64)).surface.height_m)
    assert dequantise(heights, "never") is heights
    assert not np.array_equal(dequantise(heights, 2.0), dequantise(heights, 4.0))
