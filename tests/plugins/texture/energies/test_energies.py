"""Gabor filters and their local energy against the formulas: else textures of some wavelengths are not told apart."""

from math import ceil, log2, pi

import numpy as np
import pytest
from scipy.signal import fftconvolve

from tangible_core.plugins.notes import collected
from tangible_texture.energies.filter_choice import are_strongest, filters_within_bandwidth, needed_filters
from tangible_texture.energies.gabor_bank import bank, kernel, octaves, printed_wavelengths, sigma_of_bandwidth
from tangible_texture.energies.local_energy import (
    REACH,
    energy_planes,
    mean_energies,
    padding,
    picture_spectrum,
    smoothing_px,
)
from tangible_texture.signal.smoothing import gaussian

OCTAVES = octaves(24)


def grating(shape, wavelength_px, theta_rad, height=1.0):
    rows, columns = np.indices(shape)
    along = columns * np.cos(theta_rad) + rows * np.sin(theta_rad)
    return (height * np.cos(2 * np.pi * along / wavelength_px + 0.3)).astype(np.float32)


def natural(shape, seed=0):
    """Return noise with the falling spectrum of photographs."""
    noise = np.fft.rfft2(np.random.default_rng(seed).normal(size=shape))
    frequency = np.hypot(np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])[None])
    return np.fft.irfft2(noise / np.maximum(frequency, 1 / max(shape)), shape).astype(np.float32)


def gabor(each):
    """Sample the formula to seven sigma."""
    half = ceil(7 * each.sigma_px / each.gamma)
    y, x = np.mgrid[-half : half + 1, -half : half + 1].astype(float)
    along = x * np.cos(each.theta_rad) + y * np.sin(each.theta_rad)
    across = -x * np.sin(each.theta_rad) + y * np.cos(each.theta_rad)
    envelope = np.exp(-(along**2 + (each.gamma * across) ** 2) / (2 * each.sigma_px**2))
    return 2 * envelope / envelope.sum() * np.exp(2j * np.pi * along / each.wavelength_px)


def direct(grey, filters, step_px, sigma_px):
    """The same by its definition: every filter a convolution at full resolution, in float64, with its whole kernel."""
    values = (grey - grey.mean(dtype=float)) / grey.std(dtype=float)
    planes = []
    for each in filters:
        waves = gabor(each)
        wide_px = smoothing_px(each, sigma_px)
        around, reach = len(waves) // 2, ceil(REACH * wide_px)
        mirrored = np.pad(values, around + reach, mode="symmetric")
        energy = np.abs(fftconvolve(mirrored, waves, mode="valid")) ** 2
        tables = []
        for side, samples in zip(grey.shape, energy.shape, strict=True):
            centre = (np.arange(ceil(side / step_px)) + 0.5) * step_px - 0.5 + reach
            away = (np.arange(samples) - centre[:, None]) / wide_px
            table = np.exp(-0.5 * away**2) * (np.abs(away) <= REACH)
            tables.append(table / table.sum(axis=1, keepdims=True))
        planes.append(tables[0] @ energy @ tables[1].T)
    return np.array(planes)


def local_energy(grey, wavelengths_px, orientations=6, step_px=4, sigma_px=4.0):
    filters = bank(wavelengths_px, orientations)
    return energy_planes(picture_spectrum(grey, padding(filters, sigma_px)), filters, grey.shape, step_px, sigma_px)


def worst(found, expected):
    """Return the largest difference in a filter's plane as a share of its mean, for the worst filter."""
    return (np.abs(found - expected).max(axis=(1, 2)) / expected.mean(axis=(1, 2))).max()


@pytest.mark.parametrize("name", ["noise", "photograph"])
def test_energies_are_within_one_percent_of_the_full_bank(name):
    grey = np.random.default_rng(0).random((160, 200)).astype(np.float32) if name == "noise" else natural((180, 150))
    assert worst(local_energy(grey, OCTAVES), direct(grey, bank(OCTAVES), 4, 4.0)) < 0.01


@pytest.mark.parametrize(("step_px", "sigma_px"), [(1, 2.0), (3, 8.0), (8, 12.0), (5, 4.0)])
def test_energies_with_other_steps_and_windows_are_as_exact(step_px, sigma_px):
    grey = natural((97, 131), seed=1)
    wavelengths = (*printed_wavelengths(97)[:2], 16.0)
    found = local_energy(grey, wavelengths, 4, step_px, sigma_px)
    assert found.shape == (12, ceil(97 / step_px), ceil(131 / step_px))
    assert found.dtype == np.float32
    assert worst(found, direct(grey, bank(wavelengths, 4), step_px, sigma_px)) < 0.01


@pytest.mark.parametrize("wavelength_px", OCTAVES)
def test_grating_peaks_in_its_own_filter_with_a_known_energy(wavelength_px):
    filters = bank(OCTAVES)
    grey = grating((240, 260), wavelength_px, np.radians(60), height=3.0)
    found = local_energy(grey, OCTAVES)[:, 20:-20, 20:-20].mean(axis=(1, 2))
    best = filters[int(found.argmax())]
    assert (best.wavelength_px, np.degrees(best.theta_rad)) == pytest.approx((wavelength_px, 60))
    variance = grey.var(dtype=float)
    for each, energy in zip(filters, found, strict=True):
        away = np.array(best.frequency) - each.frequency
        turned = [away @ (np.sin(each.theta_rad + t), np.cos(each.theta_rad + t)) for t in (0, np.pi / 2)]
        widths = 2 * np.pi * each.sigma_px * np.array([1, 1 / each.gamma])
        gain = np.exp(-0.5 * ((turned * widths) ** 2).sum())
        assert energy == pytest.approx(gain**2 * 9 / variance, abs=0.002 * 9 / variance)


def test_mean_energies_are_those_of_the_mirrored_picture_and_none_of_a_flat_one():
    for value in (0.0, 0.3, -1e20, 1e-20, 255.0):
        assert not local_energy(np.full((33, 20), value, np.float32), OCTAVES).any()
    assert not local_energy(np.ones((1, 1), np.float32), OCTAVES).any()
    grey = natural((150, 140), seed=5)
    filters = bank(OCTAVES)
    means = mean_energies(picture_spectrum(grey, padding(filters, 4.0)), filters)
    assert means == pytest.approx(local_energy(grey, OCTAVES).mean(axis=(1, 2)), rel=0.5)
    tiled = np.tile(grating((128, 128), 8.0, 0.0), 2)
    [own] = mean_energies(picture_spectrum(tiled, 0), bank((8.0,), 1))
    assert own == pytest.approx(2, rel=1e-4)


@pytest.mark.parametrize("bandwidth", [0.5, 1.0, 2.0])
def test_bandwidth_at_half_height_is_the_requested_one(bandwidth):
    sigma = sigma_of_bandwidth(16.0, bandwidth)

    def height(frequency):
        return np.exp(-2 * (pi * sigma * (frequency - 1 / 16)) ** 2)

    half = np.sqrt(np.log(2) / 2) / (pi * sigma)
    assert height(1 / 16 + half) == pytest.approx(0.5)
    assert log2((1 / 16 + half) / (1 / 16 - half)) == pytest.approx(bandwidth)


def test_bank_has_every_direction_at_the_frequencies_that_the_paper_prints():
    filters = bank((4.0, 8.0), 6)
    assert [each.wavelength_px for each in filters] == [4.0] * 6 + [8.0] * 6
    assert np.degrees([each.theta_rad for each in filters[:6]]) == pytest.approx([0, 30, 60, 90, 120, 150])
    assert filters[3].frequency == pytest.approx((0.25, 0))
    assert bank((4.0,), 1)[0].gamma == bank((4.0,), 2)[0].gamma == 1
    offsets = np.array([2**-0.5, 2**0.5, 2**1.5]) * 2 / 128  # i = 0.5, 1.5, 2.5 less 1, doubled
    expected = np.concatenate([0.25 - offsets, [0.25 - 2**3.5 / 128], 0.25 + offsets, [0.25 + 2**3.5 / 128]])
    assert np.sort(1 / np.array(printed_wavelengths(128))) == pytest.approx(np.sort(expected))
    assert len(printed_wavelengths(512)) == 12
    assert list(printed_wavelengths(512)) == sorted(printed_wavelengths(512))
    assert len(printed_wavelengths(511)) == len(printed_wavelengths(256)) == 10
    assert max(1 / printed_wavelength for printed_wavelength in printed_wavelengths(300)) == pytest.approx(
        0.25 + 2**4.5 / 300
    )
    for width in (1, 7, 15):
        assert printed_wavelengths(width) == (4.0,)
    for width in range(16, 2000, 37):
        frequencies = 1 / np.array(printed_wavelengths(width))
        assert 0.07 < frequencies.min() < 0.25 < frequencies.max() < 0.43


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


FILTERS = bank(octaves(24))


def stripes(wavelength_px):
    columns = np.arange(810) + 0.5  # so that its mirror image goes on with the wave
    return np.cos(2 * np.pi / wavelength_px * columns).astype(np.float32)[None].repeat(60, axis=0)


def test_filters_of_the_share_bandwidth_and_finest_octave_stay():
    energies = np.array([1.0, 60.0, 4.0, 35.0])
    assert are_strongest(energies, 0.95).tolist() == [False, True, False, True]
    assert are_strongest(energies, 0.96).tolist() == [False, True, True, True]
    assert are_strongest(energies, 0.5).tolist() == [False, True, False, False]
    assert are_strongest(np.array([50.0, 25.0, 25.0]), 0.75).tolist() == [True, True, False]
    assert are_strongest(energies, 1.0).all()
    assert are_strongest(np.zeros(3)).all()
    kept = filters_within_bandwidth(stripes(10), FILTERS)
    assert kept == FILTERS[12:]
    assert filters_within_bandwidth(stripes(7.5), FILTERS) == FILTERS[6:]
    assert filters_within_bandwidth(stripes(90), FILTERS) == FILTERS  # no filter would be left
    sharp = np.random.default_rng(0).random((200, 200)).astype(np.float32)
    with collected() as notes:
        assert needed_filters(sharp, FILTERS, skip_weak=False, skip_octaves=True) == FILTERS
    assert notes == []
    blurred = gaussian(sharp[..., None], 3.0)[..., 0]
    with collected() as notes:
        kept = needed_filters(blurred, FILTERS, skip_weak=False, skip_octaves=True)
    assert kept == FILTERS[6:]
    [message] = notes
    assert message.startswith("6 of 24 filters left out")
