"""Bands of a pair: where they lie and what they average."""

import numpy as np
import pytest

from tangible_depth.dense.confidence import flat_pixels
from tangible_depth.dense.span import Span
from tangible_depth.search import bands as module
from tangible_depth.search.bands import COUNT, HIGH_PX, RADIUS, TALL, match_bands
from tangible_depth.search.pairs import Pair
from tangible_depth.sgm.census import BLOCK


def noise(*shape: int) -> Pair:
    """Return a pair without any structure."""
    return Pair.of(*np.random.default_rng(0).integers(0, 256, (2, *shape), np.uint8))


@pytest.mark.parametrize("height", [16, 33, 100, 1000])
def test_bands_lie_in_the_middle_of_equal_parts(height: int):
    expected = [(2 * i + 1) * height // (2 * COUNT) for i in range(COUNT)]
    assert match_bands(noise(height, 40), Span(0, 15)).rows.tolist() == expected


@pytest.mark.parametrize(("width", "span", "factor"), [(100, 256, 1), (100, 257, 2), (1280, 64, 1), (1281, 64, 2)])
def test_columns_are_averaged_until_width_and_range_are_small_enough(width: int, span: int, factor: int):
    found = match_bands(noise(16, width), Span(0, span - 1))
    assert (found.factor, found.disparity.shape) == (factor, (COUNT, -(-width // factor)))


@pytest.mark.parametrize("factor", [1, 2, 3])
@pytest.mark.parametrize("middle", [-9, 0, 5, 18, 30])
def test_rows_of_a_band_are_means_with_the_edge_repeated(factor: int, middle: int):
    view = np.random.default_rng(1).integers(0, 256, (20, 37), np.uint8)
    columns = -(-37 // factor)
    means = np.zeros(columns + -columns % BLOCK + 2 * RADIUS, np.uint8)
    module._average_rows(view, middle, factor, columns, np.empty(columns * factor, np.int32), means)
    rows = view[np.clip(np.arange(middle - 1, middle + 2), 0, 19)].astype(int)
    whole = np.pad(rows, ((0, 0), (0, columns * factor - 37)), mode="edge").reshape(HIGH_PX, columns, factor)
    expected = np.floor(whole.sum(axis=(0, 2)) / (HIGH_PX * factor) + 0.5)
    assert np.array_equal(means, np.pad(expected, (RADIUS, means.size - columns - RADIUS), mode="edge"))


def test_flat_columns_of_a_band_are_flat_pixels_of_its_middle_row():
    random = np.random.default_rng(2)
    for _ in range(20):
        band = np.repeat(random.integers(0, 3, (TALL, 12)), 6, axis=1).astype(np.uint8)
        band[random.integers(0, TALL), random.integers(0, 72)] += 1
        flat = np.empty(72 - 2 * RADIUS, np.bool_)
        module._find_flat_columns(band, flat)
        assert np.array_equal(flat, flat_pixels(band)[RADIUS, RADIUS:-RADIUS])


def test_loss_is_the_share_of_the_matches_that_are_specks(monkeypatch: pytest.MonkeyPatch):
    left = np.random.default_rng(0).integers(0, 256, (64, 90), np.uint8)
    pair = Pair.of(left, np.roll(left, -3, axis=1))
    monkeypatch.setattr(module, "remove_speckles", lambda *_: 0)
    whole = match_bands(pair, Span(0, 15))
    assert whole.loss == 0
    monkeypatch.setattr(module, "remove_speckles", lambda *_: 300)
    found = match_bands(pair, Span(0, 15))
    assert (found.known, found.loss) == (whole.known - 300, 300 / whole.known)
