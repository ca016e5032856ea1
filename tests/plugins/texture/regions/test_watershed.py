"""The watershed on pictures of a known answer, and its borders at full size."""

import numpy as np
import pytest

from tangible_texture.features.channels import channels
from tangible_texture.regions.basins import basins
from tangible_texture.regions.refining import refine_labels
from tangible_texture.regions.watershed import watershed
from tangible_texture.signal.slopes import slopes
from tangible_texture.signal.smoothing import gaussian
from wavy_cells import smooth_scene


class TestWatershed:
    def test_waters_meet_on_the_ridge(self):
        height = np.array([[0, 1, 2, 9, 3, 2, 1, 0]], np.float32)
        markers = np.array([[0, -1, -1, -1, -1, -1, -1, 1]], np.int32)
        found = watershed(height, markers)[0]
        assert np.delete(found, 3).tolist() == [0, 0, 0, 1, 1, 1, 1]
        assert found[3] in (0, 1)

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

    def test_landscape_without_a_marker_is_not_flooded(self):
        assert np.all(watershed(np.ones((3, 4), np.float32), np.full((3, 4), -1, np.int32)) == -1)

    def test_flat_landscape_goes_to_the_nearest_marker(self):
        markers = np.array([[3, -1, -1, -1, -1, 5]], np.int32)
        assert watershed(np.zeros((1, 6), np.float32), markers).tolist() == [[3, 3, 3, 5, 5, 5]]

    @pytest.mark.parametrize("seed", range(3))
    def test_watershed_agrees_with_scikit_image(self, seed: int):
        from skimage.segmentation import watershed as reference

        picture, _ = smooth_scene(seed, noise=5)
        height = slopes(gaussian(channels(picture, colour=False), 2.0))[0]
        markers, count = basins(height, [float(np.quantile(height, 0.6))], 100)
        assert count > 5
        expected = reference(height, markers + 1, connectivity=1) - 1
        assert np.mean(watershed(height, markers) == expected) >= 0.99

    @pytest.mark.parametrize("seed", range(3))
    def test_parts_filled_by_basins_match_the_watershed(self, seed: int):
        picture, _ = smooth_scene(seed, noise=5)
        height = slopes(gaussian(channels(picture, colour=False), 2.0))[0]
        level = float(np.quantile(height, 0.6))
        few, count = basins(height, [level], 100)
        more, same = basins(height, [level, 1.5 * level], 100)
        assert (count, True) == (same, np.count_nonzero(more >= 0) > 1.2 * np.count_nonzero(few >= 0))
        assert np.mean(watershed(height, more) == watershed(height, few)) > 0.999

    def test_tiles_leave_no_seams(self, monkeypatch: pytest.MonkeyPatch):
        height = slopes(gaussian(channels(smooth_scene(0, noise=5)[0], colour=False), 2.0))[0]
        markers, _ = basins(height, [float(np.quantile(height, 0.6))], 100)
        whole = watershed(height, markers)
        monkeypatch.setattr("tangible_texture.regions.watershed.TILE_PX", 48)
        assert np.array_equal(watershed(height, markers), whole)

    def test_tile_without_a_marker_is_flooded(self, monkeypatch: pytest.MonkeyPatch):
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

    def test_region_of_one_cell_stays(self):
        labels = np.zeros((5, 5), np.int32)
        labels[2, 2] = 1
        at = np.arange(10) // 2
        assert np.count_nonzero(refine_labels(labels, at, at, np.zeros((10, 10), np.float32)) == 1) >= 4
