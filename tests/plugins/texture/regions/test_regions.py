"""Basins, floods, edges and merging on pictures of a known answer: else segments leak or break."""

import numpy as np
import pytest

from tangible_texture.features.cells import channels
from tangible_texture.regions.borders import Border, Landscape, borders, canny_edges, landscape
from tangible_texture.regions.merging import merge, weakest_border
from tangible_texture.regions.refining import refine_labels
from tangible_texture.regions.watershed import basins, watershed
from tangible_texture.signal.smoothing import gaussian, slopes
from wavy_cells import smooth_scene


class TestWatershed:
    def test_water_goes_round_a_wall_and_not_over_the_frame(self):
        height = np.zeros((5, 5), np.float32)
        height[:4, 2] = 1
        markers = np.full((5, 5), -1, np.int32)
        markers[0, 0], markers[0, 4] = 7, 8
        assert watershed(height, markers)[:, [0, 4]].tolist() == [[7, 8]] * 5

    @pytest.mark.parametrize("high", [100, 10_000])
    def test_low_heights_are_told_apart_beside_a_high_one(self, high: float):
        height = np.array([[0, 1, 2, 1, 1, 1, 1, 1, 0, high]], np.float32)
        markers = np.array([[0, -1, -1, -1, -1, -1, -1, -1, 1, -1]], np.int32)
        assert np.delete(watershed(height, markers)[0], 2).tolist() == [0, 0, 1, 1, 1, 1, 1, 1, 1]

    @pytest.mark.parametrize("seed", range(3))
    def test_watershed_agrees_with_scikit_image(self, seed: int):
        from skimage.segmentation import watershed as reference

        picture, _ = smooth_scene(seed, noise=5)
        height = slopes(gaussian(channels(picture, colour=False), 2.0))[0]
        markers, count = basins(height, [float(np.quantile(height, 0.6))], 100)
        assert count > 5
        expected = reference(height, markers + 1, connectivity=1) - 1
        assert np.mean(watershed(height, markers) == expected) >= 0.99

    def test_tiles_leave_no_seams_and_are_flooded_without_a_marker(self, monkeypatch: pytest.MonkeyPatch):
        height = slopes(gaussian(channels(smooth_scene(0, noise=5)[0], colour=False), 2.0))[0]
        markers, _ = basins(height, [float(np.quantile(height, 0.6))], 100)
        whole = watershed(height, markers)
        monkeypatch.setattr("tangible_texture.regions.watershed.TILE_PX", 48)
        assert np.array_equal(watershed(height, markers), whole)
        monkeypatch.setattr("tangible_texture.regions.watershed.TILE_PX", 8)
        monkeypatch.setattr("tangible_texture.regions.watershed.AROUND_PX", 2)
        markers = np.full((4, 40), -1, np.int32)
        markers[0, 0] = 5
        assert np.all(watershed(np.ones((4, 40), np.float32), markers) == 5)


class TestRefining:
    def test_cells_refined_to_pixels_have_borders_on_the_crest(self):
        height = np.zeros((9, 11), np.float32)
        height[:, 5] = 1
        labels = np.array([[0, 0, 0, 1, 1, 1]] * 5, np.int32)
        found = refine_labels(labels, np.arange(9) // 2, np.arange(11) // 2, height)
        assert np.delete(found, 5, axis=1).tolist() == [[0] * 5 + [1] * 5] * 9


class TestBasins:
    HEIGHT = np.array([[1, 1, 9, 3, 3, 9, 2], [1, 1, 9, 3, 3, 9, 2], [9, 9, 9, 9, 9, 9, 9]], np.float32)

    def test_basins_are_parts_of_size_at_the_highest_level(self):
        apart = [[0, 0, -1, 1, 1, -1, -1]] * 2 + [[-1] * 7]
        for levels, basin_count, labels in (([1, 3], 2, apart), ([1, 9], 1, [[0] * 7] * 3), ([3, 9], 2, apart)):
            found, count = basins(self.HEIGHT, levels, 4)
            assert (count, found.tolist()) == (basin_count, labels)
        for smallest_px, count in ((1, 3), (2, 3), (3, 2), (4, 2), (5, 0)):
            assert basins(self.HEIGHT, [3], smallest_px)[1] == count


@pytest.mark.parametrize("share", [0.1, 0.5, 3.0])
def test_slopes_are_divided_by_noise_bounded_by_twice_that_of_less_smoothing(share: float):
    picture = np.random.default_rng(0).random((20, 31, 1), np.float32)
    magnitude, across, down, own = slopes(picture)
    found = landscape(picture, 1e9, own[:4, :5] * np.float32(share))
    noise = np.minimum(own, 2 * share * own[0, 0])
    for one, other in zip(found, (magnitude, across, down), strict=True):
        np.testing.assert_allclose(one, other / noise, rtol=1e-4)


def test_no_slope_is_above_the_most():
    picture = np.zeros((12, 40, 1), np.float32)
    picture[:, 20:] = 1
    found = landscape(picture, 25.0, np.zeros((3, 3), np.float32))
    assert found.steep.max() == pytest.approx(25)
    assert np.abs(found.across).max() == pytest.approx(25)


@pytest.mark.parametrize("turned", [False, True])
def test_edges_lie_within_a_pixel_of_the_crest_above_the_upper_threshold(turned: bool):
    """A crest that is high in its upper half, and between both thresholds below it; beside it a lower one."""
    across = np.zeros((30, 40), np.float32)
    across[:, 10], across[:15, 9:12:2], across[:15, 10] = 6, 8, 12
    across[:, 30], across[:, 29], across[:, 31] = 9, 5, 5
    flat = np.zeros_like(across)
    land = Landscape(across.T, flat.T, across.T) if turned else Landscape(across, across, flat)
    found = canny_edges(land, 5.0, 10.0, 20.0)
    expected = np.zeros((30, 40), np.uint8)
    expected[:, 9:12] = 255
    found = found.T if turned else found
    assert np.array_equal(found[2:-2], expected[2:-2])


class TestMerging:
    LABELS = np.array([[0, 0, 1], [0, 2, 1]], np.int32)
    HEIGHT = np.array([[1, 2, 8], [4, 16, 32]], np.float32)

    def test_slope_across_a_border_is_an_edge_if_strong_enough(self):
        edges = np.array([[0, 0, 255], [0, 0, 0]], np.uint8)
        flat = np.zeros_like(self.HEIGHT)
        assert borders(self.LABELS, Landscape(self.HEIGHT, flat, flat), edges, 4) == {
            (0, 1): Border(1, 8, 1),
            (0, 2): Border(2, 32, 0),
            (1, 2): Border(1, 32, 0),
        }
        edges, flat, steep = np.zeros((2, 3), np.uint8), np.zeros((2, 3), np.float32), np.full((2, 3), -4, np.float32)
        for land, expected in ((Landscape(steep, steep, flat), (1, 1, 1)), (Landscape(steep, flat, steep), (0, 1, 0))):
            found = borders(self.LABELS, land, edges, 4)
            assert tuple(found[pair].edges for pair in ((0, 1), (0, 2), (1, 2))) == expected
        edges = np.zeros((2, 3), np.uint8)
        for across, down, expected in ((1.9, 1.9, (1, 2, 1)), (1.8, 1.8, (0, 0, 0)), (2.7, 1.0, (1, 1, 1))):
            rises = (np.full((2, 3), each, np.float32) for each in (across, down))
            found = borders(self.LABELS, Landscape(self.HEIGHT, *rises), edges, 4)
            assert tuple(found[pair].edges for pair in ((0, 1), (0, 2), (1, 2))) == expected

    def test_regions_are_merged_without_edges_and_from_the_lowest_border(self):
        found = {(0, 1): Border(10, 90, 9), (1, 2): Border(10, 50, 1), (0, 2): Border(10, 90, 9)}
        assert merge([50, 50, 50], found, most=9).tolist() == [0, 1, 1]
        found = {(0, 1): Border(10, 90, 9), (1, 2): Border(10, 50, 9), (2, 3): Border(10, 60, 9)}
        assert merge([50] * 4, found, most=4).tolist() == [0, 1, 2, 3]
        assert merge([50] * 4, found, most=3).tolist() == [0, 1, 1, 3]
        assert merge([50] * 4, found, most=1).tolist() == [0] * 4
        found = {(0, 1): Border(10, 10, 0), (0, 2): Border(9, 90, 2), (1, 2): Border(1, 9, 1)}
        assert merge([50] * 3, found, most=9).tolist() == [0, 0, 0]  # 3 of 10 pairs: neither holds
        for edges, merged in ((6, [0, 1]), (5.9, [0, 0])):
            assert merge([50, 50], {(0, 1): Border(10, 50, edges)}, most=2).tolist() == merged
        found = {(0, 1): Border(10, 50, 9), (1, 2): Border(10, 60, 9), (2, 3): Border(10, 45, 9)}
        assert merge([100, 100, 100, 1000], found, most=3).tolist() == [0, 0, 2, 3]
        assert merge([1000, 100, 60, 1000], found, most=3).tolist() == [0, 1, 1, 3]
        alike = {(0, 1): Border(10, 50, 9), (2, 3): Border(10, 50, 9)}
        assert merge([100, 100, 1000, 20], alike, most=3).tolist() == [0, 1, 2, 2]
        found = {(0, 1): Border(10, 0, 0), (0, 2): Border(10, 0, 3), (1, 2): Border(10, 0, 9), (1, 3): Border(10, 0, 7)}
        assert weakest_border(found, np.array([0, 0, 2, 3], np.int32)) == 0.6
        assert weakest_border(found, np.array([0, 0, 2, 0], np.int32)) == 0.6
        assert weakest_border(found, np.array([3, 3, 2, 0], np.int32)) == 0.6
        assert weakest_border(found, np.array([0, 0, 0, 3], np.int32)) == 0.7
        assert weakest_border(found, np.zeros(4, np.int32)) == 0
