"""Local energy against gratings of known energy, and against the same filters applied one by one in float64."""

from math import ceil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import fftconvolve

from tangible_core.compiled import threads
from tangible_core.errors import PictureError
from tangible_texture.energies.gabor_bank import bank, octaves, printed_wavelengths
from tangible_texture.energies.local_energy import (
    REACH,
    energy_planes,
    local_energy,
    mean_energies,
    padding,
    smoothing_px,
    spectrum_of,
    standardise,
)

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


def worst(found, expected):
    """Return the largest difference in a filter's plane as a share of its mean, for the worst filter."""
    return (np.abs(found - expected).max(axis=(1, 2)) / expected.mean(axis=(1, 2))).max()


@pytest.mark.parametrize("name", ["noise", "photograph"])
def test_energies_are_within_one_percent_of_the_full_bank(name):
    grey = np.random.default_rng(0).random((160, 200)).astype(np.float32) if name == "noise" else natural((180, 150))
    assert worst(local_energy(grey, OCTAVES), direct(grey, bank(OCTAVES), 4, 4.0)) < 0.01


@pytest.mark.parametrize("name", ["gratings", "edge"])
def test_energies_of_weak_filters_are_within_a_thousandth_of_the_strongest(name):
    edge = np.repeat((np.arange(160) > 70).astype(np.float32)[None], 140, axis=0)
    grey = edge if name == "edge" else np.hstack([grating((150, 80), 5.0, 0.4), grating((150, 90), 11.0, 2.0)])
    expected = direct(grey, bank(OCTAVES), 4, 4.0)
    means = expected.mean(axis=(1, 2))
    away = np.abs(local_energy(grey, OCTAVES) - expected).max(axis=(1, 2))
    assert (away < 0.01 * means + 0.001 * means.max()).all()


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


def test_wave_of_unit_deviation_has_the_energy_two():
    found = local_energy(grating((256, 256), 2 * np.sqrt(2), 0.0), OCTAVES[:1])
    assert found[0, 10:-10, 10:-10].mean() == pytest.approx(2, rel=2e-3)


@pytest.mark.parametrize("scale", [1e-20, 1e-3, 255.0, 1e20])
def test_energies_under_gain_and_offset_are_the_same(scale):
    grey = natural((60, 70), seed=2)
    found = local_energy(np.float32(scale) * (grey + np.float32(1.5)), OCTAVES[:3])
    expected = local_energy(grey, OCTAVES[:3])
    assert worst(found, expected) < 1e-4


def test_flat_picture_has_no_energy():
    for value in (0.0, 0.3, -1e20, 1e-20, 255.0):
        assert not local_energy(np.full((33, 20), value, np.float32), OCTAVES).any()
    assert not local_energy(np.ones((1, 1), np.float32), OCTAVES).any()


@given(st.integers(1, 20), st.integers(1, 20), st.integers(1, 9))
def test_energies_of_every_size_are_finite(rows, columns, step_px):
    grey = np.random.default_rng(rows).random((rows, columns)).astype(np.float32)
    found = local_energy(grey, OCTAVES, 3, step_px)
    assert found.shape == (12, ceil(rows / step_px), ceil(columns / step_px))
    assert np.isfinite(found).all()
    assert (found >= 0).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_non_finite_value_is_named_with_its_place(bad):
    grey = natural((20, 30))
    grey[7, 11] = bad
    with pytest.raises(PictureError, match="row 7, column 11"):
        local_energy(grey, OCTAVES)


@pytest.mark.usefixtures("unchecked_shapes")
def test_array_of_another_shape_is_refused():
    for shape in ((0, 4), (4, 4, 3)):
        with pytest.raises(PictureError, match="grey is"):
            local_energy(np.zeros(shape, np.float32), OCTAVES)


def test_energies_of_a_flipped_or_turned_picture_move_along():
    grey = natural((128, 128), seed=3)
    found = local_energy(grey, OCTAVES).reshape(4, 6, 32, 32)
    flipped = local_energy(grey[:, ::-1], OCTAVES).reshape(4, 6, 32, 32)
    mirror = [0, 5, 4, 3, 2, 1]  # t becomes 180 degrees - t
    assert worst(flipped[:, mirror, :, ::-1].reshape(24, 32, 32), found.reshape(24, 32, 32)) < 0.01
    turned = local_energy(np.rot90(grey), OCTAVES).reshape(4, 6, 32, 32)
    quarter = [3, 4, 5, 0, 1, 2]  # t becomes t + 90 degrees
    back = np.rot90(turned[:, quarter], -1, axes=(2, 3))
    assert worst(back.reshape(24, 32, 32), found.reshape(24, 32, 32)) < 0.01


def test_energies_do_not_wrap_around_the_frame():
    grey = np.zeros((200, 200), np.float32)
    grey[:, :30] = grating((200, 30), 5.66, 0.0)
    found = local_energy(grey, OCTAVES)
    assert found[:, :, -3:].max() < 1e-3 * found.max()


def test_energies_with_any_number_of_threads_are_the_same(monkeypatch):
    grey = natural((90, 70), seed=4)
    planes = []
    for count in (1, 3):
        monkeypatch.setattr(threads, "thread_count", lambda count=count: count)
        planes.append(local_energy(grey, OCTAVES))
    assert np.array_equal(*planes)


def test_mean_energies_are_those_of_the_mirrored_picture():
    grey = natural((150, 140), seed=5)
    filters = bank(OCTAVES)
    means = mean_energies(spectrum_of(grey, padding(filters, 4.0)), filters)
    assert means == pytest.approx(local_energy(grey, OCTAVES).mean(axis=(1, 2)), rel=0.5)
    tiled = np.tile(grating((128, 128), 8.0, 0.0), 2)
    [own] = mean_energies(spectrum_of(tiled, 0), bank((8.0,), 1))
    assert own == pytest.approx(2, rel=1e-4)


def test_energies_of_some_filters_match_those_of_all():
    grey = natural((64, 64), seed=6)
    filters = bank(OCTAVES)
    spectrum = spectrum_of(grey, padding(filters, 4.0))
    some = energy_planes(spectrum, filters[5:8], grey.shape, 4, 4.0)
    assert np.array_equal(some, local_energy(grey, OCTAVES)[5:8])
    assert energy_planes(spectrum, [], grey.shape, 4, 4.0).shape == (0, 16, 16)


def test_standardised_picture_has_mean_0_and_deviation_1():
    values = standardise(np.random.default_rng(0).normal(7, 1e-3, (50, 60)).astype(np.float32))
    assert values.mean(dtype=float) == pytest.approx(0, abs=1e-3)
    assert values.std(dtype=float) == pytest.approx(1, rel=1e-5)
