"""Heights of features by width. Otherwise a feature would be called felt that lies below the threshold."""

import math

import numpy as np
import pytest

from flights import shape
from tangible_core.data import Relief
from tangible_core.preflight.bumps import feature_m, reduce_relief, threshold_m


def sine_response(wavelength_m: float, width_m: float) -> float:
    u = (2 * math.pi * width_m / wavelength_m) ** 2
    return (math.exp(-u / 8) - math.exp(-2 * u)) / (1 / math.sqrt(1.25) - 1 / math.sqrt(5))


@pytest.mark.parametrize("cells", [64, 256, 1024])
@pytest.mark.parametrize("width_m", [0.0032, 0.005])
def test_feature_m_ridge_has_its_height_at_any_resolution(cells: int, width_m: float):
    ridge = shape(lambda x, y: 1e-3 * np.exp(-(x**2) / (2 * width_m**2)), cells)
    assert feature_m(ridge.relief, width_m) == pytest.approx(1e-3, rel=0.03)


@pytest.mark.parametrize("wavelength_m", [0.01, 0.016, 0.04])
def test_feature_m_sine_matches_the_formula(wavelength_m: float):
    wave = shape(lambda x, y: 5e-4 * np.sin(2 * np.pi * x / wavelength_m), 512)
    expected = 5e-4 * sine_response(wavelength_m, 0.0032)
    assert feature_m(wave.relief, 0.0032) == pytest.approx(
        expected, rel=0.1
    )  # the sine ends half a cell off the border


@pytest.mark.parametrize("width_m", [0.001, 0.0032, 0.01, 0.032])
def test_feature_m_plane_has_no_feature(width_m: float):
    plane = shape(lambda x, y: 0.4 * x - 0.2 * y, 100)
    assert feature_m(plane.relief, width_m) < 1e-7


@pytest.mark.parametrize("along", [False, True], ids=["x", "y"])
@pytest.mark.parametrize("cells", [(18, 100), (100, 24), (1024, 200)])
def test_feature_m_is_that_of_metres_where_cells_are_no_squares(cells: tuple[int, int], along: bool):
    """A ridge and a plane, 80 by 60 mm; beyond the borders a plane goes on along both axes."""
    y, x = (np.indices(cells) + 0.5) * np.array([0.06 / cells[0], 0.08 / cells[1]]).reshape(2, 1, 1)
    ridge = 1e-3 * np.exp(-(((y - 0.03) if along else (x - 0.04)) ** 2) / (2 * 0.008**2))
    assert feature_m(Relief(np.float32(ridge), (0.08, 0.06)), 0.008) == pytest.approx(1e-3, rel=0.06)
    assert feature_m(Relief(np.float32(0.4 * x - 0.2 * y + 0.02), (0.08, 0.06)), 0.008) < 1e-7


def test_reduced_relief_has_cells_of_about_the_size_along_both_axes():
    fine = Relief(np.zeros((400, 900), np.float32), (0.09, 0.03))
    assert reduce_relief(fine, 0.001).height_m.shape == (30, 90)
    assert reduce_relief(fine, 0.0009).height_m.shape == (34, 100)
    assert reduce_relief(fine, 0.0001).height_m.shape == (300, 900)
    assert reduce_relief(fine, 1.0).height_m.shape == (1, 1)
    assert reduce_relief(fine, 1e-6).height_m.shape == (400, 900)


def test_threshold_m_is_a_power_through_the_measurements():
    assert threshold_m(3.2e-3) == pytest.approx(29e-6)
    assert threshold_m(10e-3) == pytest.approx(130e-6)
    power = math.log(threshold_m(0.02) / threshold_m(0.01)) / math.log(2)
    assert power == pytest.approx(1.3, abs=0.05)
