"""Heights of features, width by width, on ridges and sines, for which the answer is a formula."""

import math

import numpy as np
import pytest

from flights import shape
from tangible_core.preflight.bumps import feature_m, leakage, threshold_m


def sine_response(wavelength_m: float, width_m: float) -> float:
    u = (2 * math.pi * width_m / wavelength_m) ** 2
    return (math.exp(-u / 8) - math.exp(-2 * u)) / (1 / math.sqrt(1.25) - 1 / math.sqrt(5))


@pytest.mark.parametrize("cells", [64, 256, 1024])
@pytest.mark.parametrize("width_m", [0.0032, 0.005])
def test_feature_m_ridge_has_its_height_at_any_resolution(cells: int, width_m: float):
    ridge = shape(lambda x, y: 1e-3 * np.exp(-(x**2) / (2 * width_m**2)), cells)
    assert feature_m(ridge.relief, width_m) == pytest.approx(1e-3, rel=0.03)


def test_leakage_predicts_a_hill_in_another_band():
    hill = shape(lambda x, y: 1e-3 * np.exp(-(x**2 + y**2) / (2 * 0.005**2)), 512)
    own = feature_m(hill.relief, 0.005)
    assert feature_m(hill.relief, 0.002) == pytest.approx(own * leakage(0.005, 0.002), rel=0.03)
    assert leakage(0.005, 0.005) == 1


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


def test_threshold_m_is_a_power_through_the_measurements():
    assert threshold_m(3.2e-3) == pytest.approx(29e-6)
    assert threshold_m(10e-3) == pytest.approx(130e-6)
    power = math.log(threshold_m(0.02) / threshold_m(0.01)) / math.log(2)
    assert power == pytest.approx(1.3, abs=0.05)
