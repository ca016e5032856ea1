"""Features in windows of three widths, and what they leave out."""

import numpy as np
import pytest

from tangible_core.plugins.notes import collected
from tangible_texture.features import features as module
from tangible_texture.features.cells import cap_rare_values
from tangible_texture.features.features import features
from tangible_texture.features.patterns import PATTERNS


@pytest.mark.parametrize(
    ("shape", "widths_px"),
    [((320, 320), (5, 10, 18)), ((999, 2000), (5, 10, 18)), ((240, 240), (5, 7.5, 13.5)), ((9, 40), (4.5, 5, 9))],
)
def test_windows_of_small_pictures_are_down_to_half_as_wide(shape: tuple[int, int], widths_px: tuple[float, ...]):
    assert module._widths(shape[0] * shape[1]) == pytest.approx(widths_px)


def halves(shape: tuple[int, int], columns: int) -> np.ndarray:
    """Return noise, as fine as it can be on the left and coarser on the right."""
    random = np.random.default_rng(4)
    coarse = random.random((shape[0] // 4, shape[1] // 4)).repeat(4, axis=0).repeat(4, axis=1)
    return np.where(np.arange(shape[1]) < columns, random.random(shape), coarse).astype(np.float32)


def test_planes_are_standardised_and_those_of_colour_weigh_three_times_as_much():
    grey = halves((96, 160), 80)
    plain = features(grey, 6.0, 0.0, colour=False)
    painted = features(np.dstack([grey, grey[::-1], np.roll(grey, 5, axis=0)]), 6.0, 0.0, colour=True)
    for window in plain[:3]:
        assert window.planes.std(axis=1) == pytest.approx(1, abs=1e-3)
    for window in painted[:3]:
        assert window.planes.std(axis=1) == pytest.approx(np.repeat([1, 3], [len(window.planes) - 2, 2]), abs=1e-2)


@pytest.mark.parametrize(
    ("shape", "wide"), [((124, 400), (31, 100)), ((400, 124), (100, 31)), ((128, 132), (8, 9)), ((140, 128), (9, 8))]
)
def test_wide_windows_have_fewer_values_where_both_sides_are_long(shape: tuple[int, int], wide: tuple[int, int]):
    assert features(halves(shape, 60), 3.0, 0.0, colour=False).wide.shape == wide


def test_filters_of_less_than_a_share_of_all_energy_are_left_out(monkeypatch: pytest.MonkeyPatch):
    from tangible_texture.energies import local_energy

    means = np.array([30, 12, 11, 9, 8, 8, 8, 8, 3, 1, 1, 1.0])
    monkeypatch.setattr(local_energy, "mean_energies", lambda *_: means)
    with collected() as notes:
        found = features(halves((96, 160), 80), 6.0, 0.1, colour=False)
    assert notes[0].startswith("9 of 12 filters left out")
    assert len(found.middle.planes) == 3 + PATTERNS


def test_even_change_in_either_direction_is_removed():
    rows, columns = np.indices((9, 14), np.float32)
    bumps = np.random.default_rng(0).random((2, 9, 14), np.float32)
    change = 0.3 * (rows - 4) - 0.2 * (columns - 6.5)
    found, plain = (module._remove_slope(each) for each in (bumps + change + 5, bumps + 5))
    np.testing.assert_allclose(found, plain, atol=1e-5)
    assert np.ptp(module._remove_slope(change[None])) < 1e-5


def test_colours_are_red_against_green_and_both_against_blue():
    paint = np.zeros((4, 20, 3), np.uint8)
    for cell, colour in enumerate([(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0), (255, 255, 255)]):
        paint[:, 4 * cell : 4 * cell + 4] = colour
    found = module._colour_planes(paint, True)
    np.testing.assert_allclose(found[:, 0], [[1.5, 0.5, 1, 1, 1], [1.25, 1.25, 0.5, 1.5, 1]], atol=1e-6)


def test_rare_values_are_limited_to_half_as_much_again_as_the_frequent_ones():
    planes = np.random.default_rng(0).permuted(np.arange(2000, dtype=np.float32).reshape(2, 1000), axis=1)
    planes[0, 7], planes[1, 8] = 1e6, 2500
    expected = planes.copy()
    expected[0, 7] = 1.5 * np.sort(planes[0])[984]
    assert np.array_equal(cap_rare_values(planes.copy().reshape(2, 25, 40)).reshape(2, 1000), expected)
