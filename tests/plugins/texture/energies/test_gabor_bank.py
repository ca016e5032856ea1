"""Gabor filters: the formula, its bandwidth, and the lists of wavelengths."""

from math import cos, log2, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_texture.energies.gabor_bank import (
    Gabor,
    bandwidth_of_sigma,
    bank,
    kernel,
    octaves,
    printed_wavelengths,
    sigma_of_bandwidth,
)


@given(st.floats(2, 500), st.floats(0.1, 5))
def test_bandwidth_of_sigma_inverts_sigma_of_bandwidth(wavelength, bandwidth):
    sigma = sigma_of_bandwidth(wavelength, bandwidth)
    assert bandwidth_of_sigma(wavelength, sigma) == pytest.approx(bandwidth, rel=1e-9)


def test_bandwidth_of_a_narrow_gaussian_is_infinite():
    assert bandwidth_of_sigma(10.0, 1.0) == float("inf")


@pytest.mark.parametrize("bandwidth", [0.5, 1.0, 2.0])
def test_bandwidth_at_half_height_is_the_requested_one(bandwidth):
    sigma = sigma_of_bandwidth(16.0, bandwidth)

    def height(frequency):
        return np.exp(-2 * (pi * sigma * (frequency - 1 / 16)) ** 2)

    half = np.sqrt(np.log(2) / 2) / (pi * sigma)
    assert height(1 / 16 + half) == pytest.approx(0.5)
    assert log2((1 / 16 + half) / (1 / 16 - half)) == pytest.approx(bandwidth)


def test_printed_frequencies_for_a_power_of_two_match_the_paper():
    offsets = np.array([2**-0.5, 2**0.5, 2**1.5]) * 2 / 128  # i = 0.5, 1.5, 2.5 less 1, doubled
    expected = np.concatenate([0.25 - offsets, [0.25 - 2**3.5 / 128], 0.25 + offsets, [0.25 + 2**3.5 / 128]])
    assert np.sort(1 / np.array(printed_wavelengths(128))) == pytest.approx(np.sort(expected))
    assert len(printed_wavelengths(512)) == 12
    assert list(printed_wavelengths(512)) == sorted(printed_wavelengths(512))


def test_printed_frequencies_for_other_widths_stay_in_range():
    assert len(printed_wavelengths(511)) == len(printed_wavelengths(256)) == 10
    assert max(1 / each for each in printed_wavelengths(300)) == pytest.approx(0.25 + 2**4.5 / 300)
    for width in (1, 7, 15):
        assert printed_wavelengths(width) == (4.0,)
    for width in range(16, 2000, 37):
        frequencies = 1 / np.array(printed_wavelengths(width))
        assert 0.07 < frequencies.min() < 0.25 < frequencies.max() < 0.43


def test_octaves_start_at_the_finest():
    assert octaves(1) == octaves(5.6) == (2 * sqrt(2),)
    assert octaves(4 * sqrt(2)) == pytest.approx((2 * sqrt(2), 4 * sqrt(2)))
    assert len(octaves(1000)) == 9


def test_bank_has_every_wavelength_in_every_direction():
    filters = bank((4.0, 8.0), 6)
    assert [each.wavelength_px for each in filters] == [4.0] * 6 + [8.0] * 6
    assert np.degrees([each.theta_rad for each in filters[:6]]) == pytest.approx([0, 30, 60, 90, 120, 150])
    assert filters[3].frequency == pytest.approx((0.25, 0))
    assert bank((4.0,), 1)[0].gamma == bank((4.0,), 2)[0].gamma == 1


def test_neighbouring_directions_meet_at_half_height():
    one = bank((8.0,), 6)[0]
    across = np.tan(np.radians(15)) / 8
    assert np.exp(-2 * (pi * one.sigma_px / one.gamma * across) ** 2) == pytest.approx(0.5)


def test_kernel_matches_its_formula():
    gabor = Gabor(6.0, np.radians(30), 6.0, 0.5)
    values = kernel(gabor)
    half = len(values) // 2
    x, y = 3, -2
    along, across = x * cos(pi / 6) + y * 0.5, -x * 0.5 + y * cos(pi / 6)
    expected = np.exp(-(along**2 + (0.5 * across) ** 2) / (2 * 6.0**2)) * np.exp(2j * pi * along / 6)
    total = 2 * pi * 6.0 * 6.0 / 0.5  # of the Gaussian, over the whole plane
    assert values[half + y, half + x] == pytest.approx(2 * expected / total, rel=2e-3)


@pytest.mark.parametrize("gabor", bank((4.0, 11.0), 3))
def test_kernel_of_every_filter_is_blind_to_grey_and_keeps_its_wave(gabor):
    values = kernel(gabor)
    assert abs(values.sum()) < 1e-12
    assert np.real(values) == pytest.approx(np.real(values)[::-1, ::-1], abs=1e-15)
    assert np.imag(values) == pytest.approx(-np.imag(values)[::-1, ::-1], abs=1e-15)
    half = len(values) // 2
    y, x = np.mgrid[-half : half + 1, -half : half + 1]
    down, right = gabor.frequency
    for phase in (0.0, 1.0):
        wave = 7 * np.cos(2 * pi * (down * y + right * x) + phase)
        assert abs((values * wave).sum()) == pytest.approx(7, rel=0.01)
