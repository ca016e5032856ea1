"""Texture segmenters, and the blocks they are built of, on pictures whose answer is known."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from label_maps import rand_index
from tangible_core.data import Views
from tangible_core.errors import PictureError
from tangible_core.plugins.notes import collected
from tangible_texture.features.channels import channels
from tangible_texture.gradient import Gradient
from tangible_texture.regions.basins import MOST_SEGMENTS, basins
from tangible_texture.regions.borders import Border, borders
from tangible_texture.regions.landscape import Landscape
from tangible_texture.regions.merging import in_reading_order, merge
from tangible_texture.regions.refining import refined
from tangible_texture.regions.watershed import watershed
from tangible_texture.signal.slopes import slopes
from tangible_texture.signal.smoothing import WIDER, gaussian, two_scales, without_specks


def cells(seed: int, count: int = 10, size: int = 256) -> np.ndarray:
    """Labels of wavy cells, each of one piece: the nearest of points on a shaken grid."""
    rng = np.random.default_rng(seed)
    rows, columns = np.indices((size, size)) / size
    waves = [0.02 * np.sin(2 * np.pi * (3 * each + rng.random())) for each in (columns, rows)]
    points = np.array([(row + 0.5, column + 0.5) for row in range(4) for column in range(4)]) / 4
    points = (points + rng.uniform(-0.08, 0.08, points.shape))[rng.permutation(16)[:count]]
    far = (rows + waves[0])[..., None] - points[:, 0], (columns + waves[1])[..., None] - points[:, 1]
    return in_reading_order(np.hypot(*far).argmin(axis=2).astype(np.int32))


def smooth_scene(seed: int, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """A picture of 8 bits, smooth in each cell: grey levels 18 apart, a shading across, a soft edge, and noise."""
    labels = cells(seed)
    rng = np.random.default_rng(seed)
    rows, columns = np.indices(labels.shape) / len(labels)
    grey = rng.permutation(np.linspace(35, 215, labels.max() + 1))[labels] + 8 * rows - 12 * columns
    soft = gaussian(grey[..., None].astype(np.float32), 0.8)[..., 0]
    return np.clip(np.rint(soft + rng.normal(0, noise, soft.shape)), 0, 255).astype(np.uint8), labels


def halves(shape: tuple[int, int], left: float, right: float, noise: float = 0.0, seed: int = 0) -> np.ndarray:
    """8 bits of grey: two flat halves side by side."""
    grey = np.where(np.arange(shape[1]) < shape[1] // 2, left, right) + np.zeros(shape)
    return np.clip(np.rint(grey + np.random.default_rng(seed).normal(0, noise, shape)), 0, 255).astype(np.uint8)


def column_of_change(labels: np.ndarray) -> np.ndarray:
    """For each row of a picture of two segments side by side, where the second begins."""
    assert np.array_equal(np.sort(labels, axis=1), labels)
    return (labels == 0).sum(axis=1)


class TestChannels:
    def test_grey_is_one_channel_however_it_comes(self):
        grey = np.random.default_rng(0).integers(0, 256, (5, 7), np.uint8)
        expected = channels(grey, colour=True)
        assert expected.shape == (5, 7, 1)
        assert expected.max() == 1
        assert np.array_equal(channels(np.repeat(grey[..., None], 3, axis=2), colour=True), expected)

    def test_types_agree_to_the_last_bit(self):
        eight = np.random.default_rng(0).integers(0, 256, (5, 7, 3), np.uint8)
        expected = channels(eight, colour=True)
        assert expected.shape == (5, 7, 3)
        opaque = np.dstack([eight, np.full((5, 7), 255, np.uint8)])
        for same in (eight.astype(np.uint16) * 257, eight / 255, np.asarray(eight / 255, np.float32), opaque):
            assert np.array_equal(channels(same, colour=True), expected)

    @pytest.mark.parametrize("scale", [1e-20, 1e20, 1e300])
    def test_scale_is_taken_out(self, scale: float):
        picture = np.random.default_rng(0).random((5, 7, 3))
        assert np.allclose(channels(picture * scale, colour=True), picture / picture.max(), rtol=1e-6)

    def test_transparency_lies_over_white(self):
        clear = np.array([[[0, 0, 0, 0], [0, 0, 255, 255]]], np.uint8)
        assert channels(clear, colour=True).tolist() == [[[1, 1, 1], [0, 0, 1]]]


class TestSmoothing:
    @given(st.integers(2, 6), st.integers(2, 6), st.data())
    def test_one_pixel_that_differs_vanishes(self, rows: int, columns: int, data: st.DataObject):
        picture = np.full((rows, columns, 1), 0.5, np.float32)
        row, column = data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, columns - 1))
        picture[row, column] = data.draw(st.sampled_from([0.0, 0.499, 0.501, 1.0]))
        assert np.all(without_specks(picture) == 0.5)

    @pytest.mark.parametrize("thing", [np.eye(9), np.tri(9), np.indices((9, 9))[1] == 4, np.indices((9, 9))[0]])
    def test_lines_corners_steps_and_slopes_stay(self, thing: np.ndarray):
        values = np.asarray(thing, np.float32)[..., None]
        assert np.array_equal(without_specks(values), values)

    def test_gaussian_mirrors_at_the_border_and_does_not_wrap(self):
        values = np.zeros((1, 40, 1), np.float32)
        values[0, 0] = 1
        found = gaussian(values, 2.0)[0, :, 0]
        assert found[:3].sum() > 0.6
        assert np.all(found[20:] == 0)
        assert found.sum() == pytest.approx(1, abs=1e-5)

    @pytest.mark.parametrize(("shape", "step"), [((512, 512), 2), ((511, 301), 2), ((30, 40), 1), ((1, 1), 1)])
    def test_two_scales(self, shape: tuple[int, int], step: int):
        noise = np.random.default_rng(0).normal(0, 1, (*shape, 2)).astype(np.float32)
        near, wide, found = two_scales(noise, 2.0)
        assert found == step
        assert near.shape == noise.shape
        assert wide.shape == (-(-shape[0] // step), -(-shape[1] // step), 2)
        if min(shape) > 300:  # what a Gaussian leaves of white noise
            assert near.std() == pytest.approx(1 / (np.sqrt(4 * np.pi) * 2), rel=0.05)
            assert wide.std() == pytest.approx(1 / (np.sqrt(4 * np.pi) * 2 * WIDER), rel=0.05)


class TestSlopes:
    def test_a_plane_has_its_slope_everywhere_inside(self):
        rows, columns = np.indices((20, 30), np.float32)
        magnitude, across, down, _ = slopes((0.003 * columns - 0.004 * rows)[..., None])
        assert np.allclose(across[:, 1:-1], 0.003, atol=1e-6)
        assert np.allclose(down[1:-1], -0.004, atol=1e-6)
        assert np.allclose(magnitude[1:-1, 1:-1], 0.005, atol=1e-6)

    def test_the_steepest_channel_counts(self):
        columns = np.indices((5, 9), np.float32)[1]
        magnitude, across, _, _ = slopes(np.dstack([0.1 * columns, -0.3 * columns, 0.2 * columns]))
        assert np.allclose(magnitude[:, 1:-1], 0.3)
        assert np.allclose(across[:, 1:-1], -0.3)

    @pytest.mark.parametrize("channel_count", [1, 3])
    def test_noise_is_measured(self, channel_count: int):
        sigma_px = 2.0
        noise = np.random.default_rng(0).normal(0, 1, (512, 512, channel_count)).astype(np.float32)
        found = slopes(gaussian(noise, sigma_px))[3]
        expected = 1 / (np.sqrt(8 * np.pi) * sigma_px**2)  # of a derivative of a Gaussian, under white noise
        assert found.mean() == pytest.approx(expected, rel=0.1)

    def test_noise_differs_from_place_to_place(self):
        noise = np.random.default_rng(0).normal(0, 1, (256, 512, 1)).astype(np.float32)
        noise[:, 256:] *= 10
        found = slopes(gaussian(noise, 2.0))[3]
        assert found[:, -1].mean() == pytest.approx(10 * found[:, 0].mean(), rel=0.1)


class TestBasins:
    HEIGHT = np.array([[1, 1, 9, 3, 3, 9, 2], [1, 1, 9, 3, 3, 9, 2], [9, 9, 9, 9, 9, 9, 9]], np.float32)

    def test_one_level(self):
        found, count = basins(self.HEIGHT, [1], 4)
        assert count == 1
        assert found.tolist() == [[0, 0, -1, -1, -1, -1, -1]] * 2 + [[-1] * 7]

    def test_a_higher_level_adds_parts_that_have_none_yet(self):
        found, count = basins(self.HEIGHT, [1, 3], 4)
        assert count == 2
        assert found.tolist() == [[0, 0, -1, 1, 1, -1, -1]] * 2 + [[-1] * 7]

    def test_a_part_with_one_basin_is_all_its_own(self):
        found, count = basins(self.HEIGHT, [1, 9], 4)
        assert count == 1
        assert np.all(found == 0)

    def test_a_part_with_several_basins_stays_as_it_is(self):
        found, count = basins(self.HEIGHT, [3, 9], 4)
        assert count == 2
        assert found.tolist() == [[0, 0, -1, 1, 1, -1, -1]] * 2 + [[-1] * 7]

    def test_corners_do_not_connect(self):
        assert basins(np.array([[0, 1], [1, 0]], np.float32), [0], 1)[1] == 2


class TestWatershed:
    def test_waters_meet_on_the_ridge(self):
        height = np.array([[0, 1, 2, 9, 3, 2, 1, 0]], np.float32)
        markers = np.array([[0, -1, -1, -1, -1, -1, -1, 1]], np.int32)
        found = watershed(height, markers)[0]
        assert np.delete(found, 3).tolist() == [0, 0, 0, 1, 1, 1, 1]
        assert found[3] in (0, 1)

    def test_water_goes_round_a_wall_and_never_over_the_picture_s_border(self):
        height = np.zeros((5, 5), np.float32)
        height[:4, 2] = 1
        markers = np.full((5, 5), -1, np.int32)
        markers[0, 0], markers[0, 4] = 7, 8
        assert watershed(height, markers)[:, [0, 4]].tolist() == [[7, 8]] * 5

    def test_without_a_marker_nothing_is_flooded(self):
        assert np.all(watershed(np.ones((3, 4), np.float32), np.full((3, 4), -1, np.int32)) == -1)

    def test_without_a_slope_the_nearest_marker_wins(self):
        markers = np.array([[3, -1, -1, -1, -1, 5]], np.int32)
        assert watershed(np.zeros((1, 6), np.float32), markers).tolist() == [[3, 3, 3, 5, 5, 5]]

    @pytest.mark.parametrize("seed", range(3))
    def test_agrees_with_scikit_image(self, seed: int):
        from skimage.segmentation import watershed as reference

        picture, _ = smooth_scene(seed, noise=5)
        height = slopes(gaussian(channels(picture, colour=False), 2.0))[0]
        markers, count = basins(height, [np.quantile(height, 0.6)], 100)
        assert count > 5
        expected = reference(height, markers + 1, connectivity=1) - 1
        assert np.mean(watershed(height, markers) == expected) >= 0.99

    @pytest.mark.parametrize("seed", range(3))
    def test_parts_that_basins_fill_are_what_it_would_flood(self, seed: int):
        picture, _ = smooth_scene(seed, noise=5)
        height = slopes(gaussian(channels(picture, colour=False), 2.0))[0]
        level = float(np.quantile(height, 0.6))
        few, count = basins(height, [level], 100)
        more, same = basins(height, [level, 1.5 * level], 100)
        assert (count, True) == (same, np.count_nonzero(more >= 0) > 1.2 * np.count_nonzero(few >= 0))
        assert np.mean(watershed(height, more) == watershed(height, few)) > 0.999

    def test_tiles_leave_no_seams(self, monkeypatch: pytest.MonkeyPatch):
        height = slopes(gaussian(channels(smooth_scene(0, noise=5)[0], colour=False), 2.0))[0]
        markers, _ = basins(height, [np.quantile(height, 0.6)], 100)
        whole = watershed(height, markers)
        monkeypatch.setattr("tangible_texture.regions.watershed.TILE_PX", 48)
        assert np.array_equal(watershed(height, markers), whole)

    def test_water_reaches_a_tile_without_a_marker(self, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setattr("tangible_texture.regions.watershed.TILE_PX", 8)
        monkeypatch.setattr("tangible_texture.regions.watershed.AROUND_PX", 2)
        markers = np.full((4, 40), -1, np.int32)
        markers[0, 0] = 5
        assert np.all(watershed(np.ones((4, 40), np.float32), markers) == 5)


class TestRefining:
    def test_cells_become_pixels_and_borders_go_where_the_crest_is(self):
        height = np.zeros((9, 11), np.float32)
        height[:, 5] = 1
        labels = np.array([[0, 0, 0, 1, 1, 1]] * 5, np.int32)
        found = refined(labels, 2, height)
        assert np.delete(found, 5, axis=1).tolist() == [[0] * 5 + [1] * 5] * 9

    def test_a_region_of_one_cell_stays(self):
        labels = np.zeros((5, 5), np.int32)
        labels[2, 2] = 1
        assert np.count_nonzero(refined(labels, 2, np.zeros((10, 10), np.float32)) == 1) >= 4


class TestMerging:
    LABELS = np.array([[0, 0, 1], [0, 2, 1]], np.int32)
    HEIGHT = np.array([[1, 2, 8], [4, 16, 32]], np.float32)

    def test_borders_are_summed_over_pairs(self):
        edges = np.array([[0, 0, 255], [0, 0, 0]], np.uint8)
        flat = np.zeros_like(self.HEIGHT)
        assert borders(self.LABELS, Landscape(self.HEIGHT, flat, flat), edges, 4) == {
            (0, 1): Border(1, 8, 1),
            (0, 2): Border(2, 32, 0),
            (1, 2): Border(1, 32, 0),
        }

    def test_what_rises_across_a_border_is_an_edge_and_what_rises_along_it_is_none(self):
        edges, flat, steep = np.zeros((2, 3), np.uint8), np.zeros((2, 3), np.float32), np.full((2, 3), -4, np.float32)
        for land, expected in ((Landscape(steep, steep, flat), (1, 1, 1)), (Landscape(steep, flat, steep), (0, 1, 0))):
            found = borders(self.LABELS, land, edges, 4)
            assert tuple(found[pair].edges for pair in ((0, 1), (0, 2), (1, 2))) == expected

    def test_one_region_has_no_border(self):
        flat = np.ones((3, 4), np.float32)
        assert borders(np.zeros((3, 4), np.int32), Landscape(flat, flat, flat), np.zeros((3, 4), np.uint8), 4) == {}

    def test_what_edges_do_not_hold_apart_is_merged_however_many_are_wanted(self):
        found = {(0, 1): Border(10, 90, 9), (1, 2): Border(10, 50, 1), (0, 2): Border(10, 90, 9)}
        assert merge([50, 50, 50], found, most=9).tolist() == [0, 1, 1]

    def test_the_lowest_border_goes_first_when_fewer_are_wanted(self):
        found = {(0, 1): Border(10, 90, 9), (1, 2): Border(10, 50, 9), (2, 3): Border(10, 60, 9)}
        assert merge([50] * 4, found, most=4).tolist() == [0, 1, 2, 3]
        assert merge([50] * 4, found, most=3).tolist() == [0, 1, 1, 3]
        assert merge([50] * 4, found, most=1).tolist() == [0] * 4

    def test_a_small_region_gives_way_before_a_large_one(self):
        found = {(0, 1): Border(10, 50, 9), (1, 2): Border(10, 60, 9)}
        assert merge([5000, 5000, 20], found, most=2).tolist() == [0, 1, 1]

    def test_borders_add_up_when_regions_merge(self):
        found = {(0, 1): Border(10, 10, 0), (0, 2): Border(9, 90, 2), (1, 2): Border(1, 9, 1)}
        assert merge([50] * 3, found, most=9).tolist() == [0, 0, 0]  # 3 of 10 pairs: neither holds

    def test_labels_are_in_reading_order(self):
        labels = np.array([[3, 3, 1], [0, 2, 1]], np.int32)
        assert in_reading_order(labels).tolist() == [[0, 0, 1], [2, 3, 1]]


class TestGradient:
    @pytest.mark.parametrize("noise", [0, 4, 12])
    @pytest.mark.parametrize("seed", range(3))
    def test_smooth_cells_are_found(self, seed: int, noise: float):
        picture, truth = smooth_scene(seed, noise)
        found = Gradient().segment(picture)
        assert rand_index(found.labels, truth) >= 0.98
        assert found.count == truth.max() + 1

    @pytest.mark.parametrize("seed", range(3))
    def test_weak_edges_are_found_in_noise(self, seed: int):
        """Steps of 9 grey levels in noise of 9, which hides them at sigma_px itself."""
        truth = cells(seed)
        rng = np.random.default_rng(seed)
        grey = 100 + 9.0 * rng.permutation(truth.max() + 1)[truth] + rng.normal(0, 9, truth.shape)
        assert rand_index(Gradient().segment(np.rint(grey).astype(np.uint8)).labels, truth) >= 0.95

    def test_more_noise_than_it_can_take_makes_fewer_segments_rather_than_more(self):
        picture, truth = smooth_scene(0, noise=60)
        assert Gradient().segment(picture).count <= truth.max() + 1

    @pytest.mark.parametrize(("left", "right", "noise"), [(90, 140, 0), (90, 140, 8), (100, 101, 0), (0, 255, 3)])
    def test_the_boundary_of_two_halves_is_where_it_is(self, left: float, right: float, noise: float):
        found = Gradient().segment(halves((80, 120), left, right, noise))
        assert found.count == 2
        assert np.all(np.abs(column_of_change(found.labels) - 60) <= 1)

    def test_clean_halves_are_found_to_the_pixel_even_beside_a_strong_edge(self):
        picture = np.repeat(np.array([[10, 16, 250]], np.uint8), 40, axis=1).repeat(60, axis=0)
        expected = np.repeat(np.array([[0, 1, 2]]), 40, axis=1).repeat(60, axis=0)
        assert np.array_equal(Gradient().segment(picture).labels, expected)

    def test_colours_of_one_brightness_are_told_apart(self):
        picture = np.zeros((60, 80, 3))
        picture[:, :40] = 0.7, 0.3, 0.3
        picture[:, 40:, 1] = (0.7 * 0.299 + 0.3 * 0.587) / 0.587  # the same luma, all of it green
        picture[:, 40:, 2] = 0.3
        found = Gradient().segment(picture)
        assert np.array_equal(found.labels, np.repeat([[0, 1]], 40, axis=1).repeat(60, axis=0))
        assert Gradient(colour=False).segment(picture).count == 1

    def test_a_rough_thing_on_a_clean_ground_is_a_segment(self):
        rows, columns = np.indices((160, 160))
        disc = np.hypot(rows - 80, columns - 80) < 45
        texture = np.random.default_rng(0).normal(170, 25, disc.shape)
        picture = np.where(disc, texture, 40).clip(0, 255).astype(np.uint8)
        found = Gradient().segment(picture).labels
        assert found[0, 0] != found[80, 80]
        assert rand_index((found != found[0, 0]).astype(int), disc.astype(int)) >= 0.95

    @pytest.mark.parametrize("segments", [1, 2, 3, 5, 9])
    def test_a_number_of_segments_is_kept_to(self, segments: int):
        picture, truth = smooth_scene(1, noise=4)
        found = Gradient(segments=segments).segment(picture)
        assert found.count == segments
        merged = np.zeros((found.count, truth.max() + 1))
        np.add.at(merged, (found.labels.ravel(), truth.ravel()), 1)
        assert merged.max(axis=0).sum() >= 0.98 * truth.size  # each cell lies in one segment

    def test_no_segment_is_invented_to_reach_a_number(self):
        assert Gradient(segments=9).segment(halves((60, 80), 60, 160, 3)).count == 2

    def test_auto_says_how_much_of_the_weakest_border_is_an_edge(self):
        picture = np.repeat([[60, 180]], 50, axis=1).repeat(80, axis=0).astype(np.uint8)
        with collected() as notes:
            Gradient().segment(picture)
        assert any(each.startswith("segments: 2, a guess worth 1.00") for each in notes)

    def test_auto_stops_at_its_bound(self):
        levels = np.random.default_rng(0).permutation(np.linspace(0, 255, 144)).reshape(12, 12)
        picture = np.kron(levels, np.ones((24, 24))).astype(np.uint8)
        assert Gradient().segment(picture).count == MOST_SEGMENTS
        assert Gradient(segments=144, sigma_px=1.5).segment(picture).count > 120

    def test_labels_are_in_reading_order(self):
        labels = Gradient().segment(smooth_scene(2, noise=3)[0]).labels
        assert np.array_equal(np.unique(labels, return_index=True)[1].argsort(), np.arange(labels.max() + 1))

    def test_left_and_right_borders_are_no_neighbours(self):
        picture = np.concatenate([halves((60, 80), 50, 150), halves((60, 80), 150, 50)], axis=1)
        assert Gradient().segment(picture).labels[:, [0, 80, -1]].tolist() == [[0, 1, 2]] * 60

    def test_confidence_falls_towards_edges(self):
        confidence = Gradient().segment(halves((60, 120), 60, 160)).confidence
        assert np.all(confidence[:, :50] == 1)
        assert np.allclose(confidence[:, 59:61], 0, atol=1e-6)
        assert np.all(np.diff(confidence[:, 50:60], axis=1) <= 0)

    @pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 2), (1, 40), (40, 1), (3, 3), (17, 9), (9, 33), (64, 64)])
    @pytest.mark.parametrize("options", [{}, {"smallest_px": 1}, {"sigma_px": 0.5}, {"segments": 5}], ids=str)
    def test_one_colour_is_one_segment_even_with_one_pixel_changed(self, shape: tuple[int, int], options: dict):
        rows, columns = shape
        for value in (0, 100, 254):
            picture = np.full(shape, value, np.uint8)
            assert Gradient(**options).segment(picture).count == 1
            for row, column in ((0, 0), (rows // 2, columns // 2), (rows - 1, 0), (0, columns // 2)):
                changed = picture.copy()
                changed[row, column] += 1
                assert Gradient(**options).segment(changed).count == 1

    @pytest.mark.parametrize("seed", range(3))
    @pytest.mark.parametrize("shape", [(64, 64), (200, 120), (96, 96, 3)])
    def test_noise_is_one_segment(self, seed: int, shape: tuple[int, ...]):
        rng = np.random.default_rng(seed)
        assert Gradient().segment(rng.normal(0.5, 0.1, shape)).count == 1
        assert Gradient().segment(rng.normal(120, 6, shape).astype(np.uint8)).count == 1

    def test_a_shading_is_one_segment(self):
        columns = np.indices((200, 256))[1]
        for picture in (columns / 256, columns.astype(np.uint8), 0.5 + 0.3 * np.sin(columns / 40)):
            assert Gradient().segment(picture).count == 1

    @given(st.integers(1, 40), st.integers(1, 40), st.integers(0, 9), st.sampled_from(["auto", 1, 2, 7, 10**6]))
    @settings(max_examples=60)
    def test_any_picture_has_sound_labels(self, rows: int, columns: int, seed: int, segments: int | str):
        rng = np.random.default_rng(seed)
        picture = np.kron(rng.integers(0, 256, (2, 2)), np.ones((rows, columns)))[:rows, :columns].astype(np.uint8)
        for each in (picture, rng.random((rows, columns)) < 0.5, rng.random((rows, columns, 4))):
            found = Gradient(segments=segments, smallest_px=1).segment(each)
            assert found.labels.shape == found.confidence.shape == (rows, columns)
            assert np.array_equal(np.unique(found.labels), np.arange(found.count))
            assert segments == "auto" or found.count <= segments
            assert (found.labels.dtype, found.confidence.dtype) == (np.int32, np.float32)
            assert 0 <= found.confidence.min() <= found.confidence.max() <= 1

    def test_type_and_scale_do_not_matter(self):
        eight = smooth_scene(0, noise=4)[0]
        expected = Gradient().segment(eight).digest()
        colour = np.repeat(eight[..., None], 3, axis=2)
        for same in (
            eight.astype(np.uint16) * 257,
            np.asarray(eight / 255, np.float32),
            eight / 255,
            colour,
            np.dstack([colour, np.full(eight.shape, 255, np.uint8)]),
            np.asfortranarray(eight),
            eight[::-1].copy()[::-1],
        ):
            assert Gradient().segment(same).digest() == expected
        for scaled in (eight * 1e20, eight * 1e-20, eight * 1e300):
            assert np.mean(Gradient().segment(scaled).labels == Gradient().segment(eight).labels) > 0.999

    @pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
    def test_what_is_not_finite_is_refused_with_its_place(self, value: float):
        picture = halves((20, 30), 50, 150) / 255
        picture[3, 5] = value
        with pytest.raises(PictureError, match="the first at row 3, column 5"):
            Gradient().segment(picture)

    def test_one_flat_colour_is_skipped(self):
        flat = np.full((20, 30, 3), (10, 200, 30), np.uint8)
        assert Gradient().skip(Views(left=flat)) == "the picture is one flat colour"
        flat[7, 9, 1] += 1
        assert Gradient().skip(Views(left=flat)) is None
        assert "one segment is asked for" in Gradient(segments=1).skip(Views(left=flat))

    @pytest.mark.parametrize(
        "options",
        [
            {"segments": 0},
            {"segments": "some"},
            {"sigma_px": 0},
            {"sigma_px": float("nan")},
            {"smallest_px": 0},
            {"contrast": 0},
            {"canny_low": 5.0},
            {"flat": 3.0},
            {"canny": 1.0},
        ],
        ids=str,
    )
    def test_wrong_options_are_refused(self, options: dict):
        with pytest.raises(ValidationError):
            Gradient(**options)

    def test_thresholds_out_of_order_are_explained(self):
        with pytest.raises(ValidationError, match=r"flat 1\.4 < canny_low 5 <= canny_high 4 does not hold"):
            Gradient(canny_low=5)

    def test_it_travels(self):
        method = Gradient(segments=3)
        assert pickle.loads(pickle.dumps(method)) == method
