"""The values of the network: what they are made of, what leaves their distances, and what they are worth."""

from collections.abc import Callable

import numpy as np
import pytest

from tangible_core.testing.synthetic.texture_scenes import KnownSegments, texture_mosaic
from tangible_texture.features.features import Features, Window, features
from tangible_texture.features.patterns import PATTERNS
from tangible_texture.learned import network
from tangible_texture.learned.network import FILTERS, LEAST_CELLS, learned_values


def found(picture: np.ndarray) -> Features:
    windows = features(picture, 24.0, 0.0, colour=False)
    assert windows is not None
    return windows


def values(picture: np.ndarray) -> np.ndarray:
    """Return the values of a picture, (rows, columns, e)."""
    window = learned_values(found(picture))
    assert window is not None
    return np.moveaxis(window.planes.reshape(-1, *window.shape), 0, 2)


@pytest.fixture(scope="module")
def scene() -> KnownSegments:
    return texture_mosaic(4, (264, 300), seed=5)


def test_values_are_centred_and_of_the_grid_of_middle_windows(scene: KnownSegments):
    windows = found(scene.picture)
    window = learned_values(windows)
    assert window is not None
    assert window.shape == windows.middle.shape == (33, 38)
    assert window.planes.mean(axis=1) == pytest.approx(0, abs=1e-4)


@pytest.mark.parametrize("turn", [np.fliplr, np.flipud, np.rot90, np.transpose])
def test_flips_and_quarter_turns_leave_distances(turn: Callable[[np.ndarray], np.ndarray], scene: KnownSegments):
    plain, turned = values(scene.picture[:256, :256]), values(np.ascontiguousarray(turn(scene.picture[:256, :256])))
    places = np.moveaxis(np.stack([turn(each) for each in np.indices((32, 32))]), 0, 2).reshape(-1, 2)
    there = plain[tuple(places.T)]
    here = turned.reshape(there.shape)
    sample = np.arange(0, len(here), 37)
    expected, distances = (np.linalg.norm(each[sample, None] - each[None, sample], axis=2) for each in (there, here))
    np.testing.assert_allclose(distances, expected, atol=0.02 * expected.max())


def test_cells_of_one_texture_lie_nearer_than_by_the_features():
    """Of a pair within a texture and one across two, the first has the smaller distance more often."""
    gains: list[float] = []
    for seed in range(4):
        scene = texture_mosaic(5, (320, 320), seed=seed)
        windows = found(scene.picture)
        window = learned_values(windows)
        assert window is not None
        labels = scene.labels[4::8, 4::8].ravel()
        learned, plain = (_share_in_order(each.planes, labels, seed) for each in (window, windows.middle))
        gains.append(learned - plain)
    assert min(gains) > 0
    assert np.mean(gains) > 0.02


def _share_in_order(planes: np.ndarray, labels: np.ndarray, seed: int) -> float:
    random = np.random.default_rng(seed)
    one, other = random.integers(0, labels.size, (2, 20_000))
    distances = np.linalg.norm(planes[:, one] - planes[:, other], axis=0)
    within, across = (distances[(labels[one] == labels[other]) == same][:4000] for same in (True, False))
    count = min(within.size, across.size)
    return float(np.mean(within[:count] < across[:count]))


def test_filter_that_is_missing_counts_as_one_without_differences(scene: KnownSegments):
    whole = found(scene.picture)
    without = [1, 2, *range(4, FILTERS)]
    rest = [*without, *range(FILTERS, FILTERS + PATTERNS)]
    narrow = Window(np.ascontiguousarray(whole.narrow.planes[rest]), whole.narrow.shape)
    even = whole.narrow.planes.copy()
    even[[0, 3]] = 0
    missing = learned_values(whole._replace(narrow=narrow, filters=tuple(without)))
    expected = learned_values(whole._replace(narrow=Window(even, whole.narrow.shape)))
    assert missing is not None
    assert expected is not None
    np.testing.assert_allclose(missing.planes, expected.planes, atol=1e-4)


def test_filters_that_the_weights_do_not_know_and_colours_are_left_out(scene: KnownSegments):
    windows = found(scene.picture)
    known, patterns = windows.narrow.planes[:FILTERS], windows.narrow.planes[FILTERS:]
    more = np.concatenate([known, 7 + known[:6], patterns, 5 + known[:2]])
    longer = windows._replace(narrow=Window(more, windows.narrow.shape), filters=tuple(range(FILTERS + 6)))
    one, other = learned_values(windows), learned_values(longer)
    assert one is not None
    assert other is not None
    np.testing.assert_array_equal(one.planes, other.planes)


def test_pictures_smaller_than_those_fitted_to_have_none(scene: KnownSegments):
    side = 4 * LEAST_CELLS
    assert learned_values(found(scene.picture[: side - 4, :side])) is None
    assert learned_values(found(scene.picture[:side, :side])) is not None


def test_windows_of_values_are_as_wide_as_those_of_features():
    """The windows before are 5 px wide, a cell of 8 px adds its own width."""
    before = 5.0**2 + 8**2 / 12 - 4**2 / 12
    widths = [float(np.sqrt(before + (8 * sigma) ** 2)) for sigma in network.WINDOWS]
    assert widths == pytest.approx([5, 10, 18], rel=0.08)


def test_weights_hold_what_their_names_say():
    weights = network._weights()
    hidden = len(weights.first)
    assert weights.first.shape == (hidden, FILTERS + PATTERNS)
    assert weights.second.shape == (len(weights.second_bias), len(network.WINDOWS) * hidden)
    assert weights.last.shape[1] == len(weights.second)
    assert all(np.isfinite(each).all() for each in weights)
