"""Features in windows of three widths and the network's values: else textures that look different are one segment."""

from collections.abc import Callable

import numpy as np
import pytest

from tangible_core.plugins.notes import collected
from tangible_core.testing.synthetic.texture_scenes import KnownSegments, texture_mosaic
from tangible_texture.features import features as module
from tangible_texture.features.cells import cap_rare_values, channels, standardise_roots, window_means
from tangible_texture.features.features import Features, features
from tangible_texture.features.patterns import PATTERNS
from tangible_texture.learned.network import MIN_CELLS, learned_values


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


def test_colours_are_opponent_and_filters_of_little_energy_left_out(monkeypatch: pytest.MonkeyPatch):
    paint = np.zeros((4, 20, 3), np.uint8)
    for cell, colour in enumerate([(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0), (255, 255, 255)]):
        paint[:, 4 * cell : 4 * cell + 4] = colour
    found = module._colour_planes(paint, True)
    np.testing.assert_allclose(found[:, 0], [[1.5, 0.5, 1, 1, 1], [1.25, 1.25, 0.5, 1.5, 1]], atol=1e-6)
    means = np.array([30, 12, 11, 9, 8, 8, 8, 8, 3, 1, 1, 1.0])
    monkeypatch.setattr(module, "mean_energies", lambda *_: means)
    with collected() as notes:
        found = features(halves((96, 160), 80), 6.0, 0.1, colour=False)
    assert notes[0].startswith("9 of 12 filters left out")
    assert len(found.middle.planes) == 3 + PATTERNS


def test_planes_are_limited_averaged_and_standardised():
    planes = np.random.default_rng(0).permuted(np.arange(2000, dtype=np.float32).reshape(2, 1000), axis=1)
    planes[0, 7], planes[1, 8] = 1e6, 2500
    expected = planes.copy()
    expected[0, 7] = 1.5 * np.sort(planes[0])[984]
    assert np.array_equal(cap_rare_values(planes.copy().reshape(2, 25, 40)).reshape(2, 1000), expected)
    planes = np.random.default_rng(4).random((3, 12, 18), np.float32)
    small = window_means(planes, 2.0, 2)
    np.testing.assert_allclose(small, window_means(planes, 2.0).reshape(3, 6, 2, 9, 2).mean(axis=(2, 4)), rtol=1e-5)
    planes = np.stack([np.random.default_rng(5).random(1000, np.float32), np.full(1000, 3, np.float32)])
    roots = np.sqrt(planes[0] + 1e-6)
    standardise_roots(planes)
    np.testing.assert_allclose(planes[0], (roots - roots.mean()) / roots.std(), atol=1e-4)
    assert (planes[1] == 0).all()


@pytest.mark.parametrize(("apart", "zero"), [(3e-7, True), (1e-5, False)])
def test_plane_that_differs_by_rounding_is_zero(apart: float, zero: bool):
    planes = np.float32([[1, 1 + apart] * 500])
    assert np.ptp(planes) > 0
    standardise_roots(planes)
    assert (planes == 0).all() == zero


class TestChannels:
    def test_channels_of_any_type_have_the_same_bits(self):
        eight = np.random.default_rng(0).integers(0, 256, (5, 7, 3), np.uint8)
        expected = channels(eight, colour=True)
        assert expected.shape == (5, 7, 3)
        opaque = np.dstack([eight, np.full((5, 7), 255, np.uint8)])
        for same in (eight.astype(np.uint16) * 257, eight / 255, np.asarray(eight / 255, np.float32), opaque):
            assert np.array_equal(channels(same, colour=True), expected)

    @pytest.mark.parametrize("scale", [1e-20, 1e20, 1e300])
    def test_channels_of_any_scale_have_a_maximum_of_one(self, scale: float):
        picture = np.random.default_rng(0).random((5, 7, 3))
        assert np.allclose(channels(picture * scale, colour=True), picture / picture.max(), rtol=1e-6)

    def test_transparency_lies_over_white(self):
        clear = np.array([[[0, 0, 0, 0], [0, 0, 255, 255]]], np.uint8)
        assert channels(clear, colour=True).tolist() == [[[1, 1, 1], [0, 0, 1]]]

    @pytest.mark.parametrize("channel", [0, 1, 2])
    def test_picture_whose_one_channel_differs_has_colour(self, channel: int):
        picture = np.full((2, 3, 3), 100, np.uint8)
        picture[0, 1, channel] = 101
        assert channels(picture, colour=True).shape == (2, 3, 3)
        assert channels(picture, colour=False).shape == (2, 3, 1)

    def test_picture_of_negative_values_is_scaled_by_the_most_negative(self):
        assert channels(np.array([[-4.0, 1.0, 2.0]]), colour=True)[0, :, 0].tolist() == [-1, 0.25, 0.5]


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


@pytest.mark.parametrize("turn", [np.fliplr, np.flipud, np.rot90, np.transpose])
def test_flips_and_quarter_turns_leave_distances(turn: Callable[[np.ndarray], np.ndarray], scene: KnownSegments):
    plain, turned = values(scene.picture[:256, :256]), values(np.ascontiguousarray(turn(scene.picture[:256, :256])))
    places = np.moveaxis(np.stack([turn(index) for index in np.indices((32, 32))]), 0, 2).reshape(-1, 2)
    there = plain[tuple(places.T)]
    here = turned.reshape(there.shape)
    sample = np.arange(0, len(here), 37)
    expected, distances = (np.linalg.norm(each[sample, None] - each[None, sample], axis=2) for each in (there, here))
    np.testing.assert_allclose(distances, expected, atol=0.02 * expected.max())


def test_cells_of_one_texture_lie_nearer_unless_pictures_are_too_small(scene: KnownSegments):
    """Of a pair within a texture and one across two, the first has the smaller distance more often."""
    gains: list[float] = []
    for seed in range(2):
        scene = texture_mosaic(5, (320, 320), seed=seed)
        windows = found(scene.picture)
        window = learned_values(windows)
        assert window is not None
        labels = scene.labels[4::8, 4::8].ravel()
        learned, plain = (_share_in_order(each.planes, labels, seed) for each in (window, windows.middle))
        gains.append(learned - plain)
    assert min(gains) > 0
    assert np.mean(gains) > 0.02
    side = 4 * MIN_CELLS
    assert learned_values(found(scene.picture[: side - 4, :side])) is None
    assert learned_values(found(scene.picture[:side, :side])) is not None


def _share_in_order(planes: np.ndarray, labels: np.ndarray, seed: int) -> float:
    random = np.random.default_rng(seed)
    one, other = random.integers(0, labels.size, (2, 20_000))
    distances = np.linalg.norm(planes[:, one] - planes[:, other], axis=0)
    within, across = (distances[(labels[one] == labels[other]) == same][:4000] for same in (True, False))
    count = min(within.size, across.size)
    return float(np.mean(within[:count] < across[:count]))
