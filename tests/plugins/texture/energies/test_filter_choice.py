"""The filters left out, and the note about them."""

import numpy as np
import pytest

from tangible_core.plugins.notes import collected
from tangible_texture.energies.filter_choice import are_strongest, filters_within_bandwidth, needed_filters
from tangible_texture.energies.gabor_bank import bank, octaves
from tangible_texture.signal.smoothing import gaussian

FILTERS = bank(octaves(24))


def stripes(wavelength_px):
    columns = np.arange(810) + 0.5  # so that its mirror image goes on with the wave
    return np.cos(2 * np.pi / wavelength_px * columns).astype(np.float32)[None].repeat(60, axis=0)


def test_strongest_filters_are_the_fewest_holding_the_share():
    energies = np.array([1.0, 60.0, 4.0, 35.0])
    assert are_strongest(energies, 0.95).tolist() == [False, True, False, True]
    assert are_strongest(energies, 0.96).tolist() == [False, True, True, True]
    assert are_strongest(energies, 0.5).tolist() == [False, True, False, False]
    assert are_strongest(np.array([50.0, 25.0, 25.0]), 0.75).tolist() == [True, True, False]
    assert are_strongest(energies, 1.0).all()
    assert are_strongest(np.zeros(3)).all()


def test_filters_up_to_root_two_of_a_wave_stay():
    kept = filters_within_bandwidth(stripes(10), FILTERS)
    assert kept == FILTERS[12:]
    assert filters_within_bandwidth(stripes(7.5), FILTERS) == FILTERS[6:]
    assert filters_within_bandwidth(stripes(90), FILTERS) == FILTERS  # no filter would be left


def test_octaves_of_a_blurred_picture_lose_the_finest():
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


def test_weak_filters_are_dropped_on_request_only():
    assert needed_filters(stripes(8), FILTERS, skip_weak=False, skip_octaves=False) == FILTERS
    kept = needed_filters(stripes(8), FILTERS, skip_weak=True, skip_octaves=False)
    assert 0 < len(kept) < 8
    assert {each.wavelength_px for each in kept} <= {each.wavelength_px for each in FILTERS[6:18]}


@pytest.mark.parametrize("value", [0.0, 0.7])
def test_filters_for_a_flat_picture_all_stay(value):
    flat = np.full((40, 40), value, np.float32)
    assert needed_filters(flat, FILTERS, skip_weak=True, skip_octaves=True) == FILTERS
