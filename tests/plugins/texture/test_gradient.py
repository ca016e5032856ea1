"""Segments by gradient, on pictures of a known answer."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from label_maps import rand_index
from tangible_core.data import Views
from tangible_core.errors import OptionError, PictureError
from tangible_core.plugins.notes import collected
from tangible_texture.gradient import Gradient
from tangible_texture.regions.basins import MOST_SEGMENTS
from wavy_cells import cells, smooth_scene


def halves(shape: tuple[int, int], left: float, right: float, noise: float = 0.0, seed: int = 0) -> np.ndarray:
    """Return 8 bits of grey: two flat halves side by side, with noise."""
    grey = np.where(np.arange(shape[1]) < shape[1] // 2, left, right) + np.zeros(shape)
    return np.clip(np.rint(grey + np.random.default_rng(seed).normal(0, noise, shape)), 0, 255).astype(np.uint8)


def column_of_change(labels: np.ndarray) -> np.ndarray:
    """Return the first column of the second segment in each row, for two segments side by side."""
    assert np.array_equal(np.sort(labels, axis=1), labels)
    return (labels == 0).sum(axis=1)


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

    def test_excessive_noise_gives_fewer_segments(self):
        picture, truth = smooth_scene(0, noise=60)
        assert Gradient().segment(picture).count <= truth.max() + 1

    @pytest.mark.parametrize(("left", "right", "noise"), [(90, 140, 0), (90, 140, 8), (100, 101, 0), (0, 255, 3)])
    def test_boundary_of_two_halves_is_exact(self, left: float, right: float, noise: float):
        found = Gradient().segment(halves((80, 120), left, right, noise))
        assert found.count == 2
        assert np.all(np.abs(column_of_change(found.labels) - 60) <= 1)

    def test_clean_halves_next_to_a_strong_edge_are_exact(self):
        picture = np.repeat(np.array([[10, 16, 250]], np.uint8), 40, axis=1).repeat(60, axis=0)
        expected = np.repeat(np.array([[0, 1, 2]]), 40, axis=1).repeat(60, axis=0)
        assert np.array_equal(Gradient().segment(picture).labels, expected)

    def test_colours_of_one_brightness_are_separated(self):
        picture = np.zeros((60, 80, 3))
        picture[:, :40] = 0.7, 0.3, 0.3
        picture[:, 40:, 1] = (0.7 * 0.299 + 0.3 * 0.587) / 0.587  # the same luma, all of it green
        picture[:, 40:, 2] = 0.3
        found = Gradient().segment(picture)
        assert np.array_equal(found.labels, np.repeat([[0, 1]], 40, axis=1).repeat(60, axis=0))
        assert Gradient(colour=False).segment(picture).count == 1

    def test_rough_object_on_a_clean_ground_is_a_segment(self):
        rows, columns = np.indices((160, 160))
        disc = np.hypot(rows - 80, columns - 80) < 45
        texture = np.random.default_rng(0).normal(170, 25, disc.shape)
        picture = np.where(disc, texture, 40).clip(0, 255).astype(np.uint8)
        found = Gradient().segment(picture).labels
        assert found[0, 0] != found[80, 80]
        assert rand_index((found != found[0, 0]).astype(int), disc.astype(int)) >= 0.95

    @pytest.mark.parametrize("segments", [1, 2, 3, 5, 9])
    def test_requested_number_of_segments_is_met(self, segments: int):
        picture, truth = smooth_scene(1, noise=4)
        found = Gradient(segments=segments).segment(picture)
        assert found.count == segments
        merged = np.zeros((found.count, truth.max() + 1))
        np.add.at(merged, (found.labels.ravel(), truth.ravel()), 1)
        assert merged.max(axis=0).sum() >= 0.98 * truth.size  # each cell lies in one segment

    def test_segments_are_not_invented_to_reach_a_number(self):
        assert Gradient(segments=9).segment(halves((60, 80), 60, 160, 3)).count == 2

    def test_auto_reports_the_weakest_border(self):
        picture = np.repeat([[60, 180]], 50, axis=1).repeat(80, axis=0).astype(np.uint8)
        with collected() as notes:
            Gradient().segment(picture)
        assert any(each.startswith("segments: 2, estimated with confidence 1.00") for each in notes)

    def test_auto_stops_at_its_bound(self):
        levels = np.random.default_rng(0).permutation(np.linspace(0, 255, 144)).reshape(12, 12)
        picture = np.kron(levels, np.ones((24, 24))).astype(np.uint8)
        assert Gradient().segment(picture).count == MOST_SEGMENTS
        assert Gradient(segments=144, sigma_px=1.5).segment(picture).count > 120

    def test_labels_are_in_reading_order(self):
        labels = Gradient().segment(smooth_scene(2, noise=3)[0]).labels
        assert np.array_equal(np.unique(labels, return_index=True)[1].argsort(), np.arange(labels.max() + 1))

    def test_left_and_right_borders_are_not_neighbours(self):
        picture = np.concatenate([halves((60, 80), 50, 150), halves((60, 80), 150, 50)], axis=1)
        assert Gradient().segment(picture).labels[:, [0, 80, -1]].tolist() == [[0, 1, 2]] * 60

    def test_confidence_falls_towards_edges(self):
        confidence = Gradient().segment(halves((60, 120), 60, 160)).confidence
        assert np.all(confidence[:, :50] == 1)
        assert np.allclose(confidence[:, 59:61], 0, atol=1e-6)
        assert np.all(np.diff(confidence[:, 50:60], axis=1) <= 0)

    @pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 2), (1, 40), (40, 1), (3, 3), (17, 9), (9, 33), (64, 64)])
    @pytest.mark.parametrize("options", [{}, {"smallest_px": 1}, {"sigma_px": 0.5}, {"segments": 5}], ids=str)
    def test_one_colour_with_one_pixel_changed_is_one_segment(self, shape: tuple[int, int], options: dict):
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

    def test_shading_is_one_segment(self):
        columns = np.indices((200, 256))[1]
        for picture in (columns / 256, columns.astype(np.uint8), 0.5 + 0.3 * np.sin(columns / 40)):
            assert Gradient().segment(picture).count == 1

    @given(st.integers(1, 40), st.integers(1, 40), st.integers(0, 9), st.sampled_from(["auto", 1, 2, 7, 10**6]))
    def test_labels_of_any_picture_are_sound(self, rows: int, columns: int, seed: int, segments: int | str):
        rng = np.random.default_rng(seed)
        picture = np.kron(rng.integers(0, 256, (2, 2)), np.ones((rows, columns)))[:rows, :columns].astype(np.uint8)
        for each in (picture, rng.random((rows, columns)) < 0.5, rng.random((rows, columns, 4))):
            found = Gradient(segments=segments, smallest_px=1).segment(each)
            assert found.labels.shape == found.confidence.shape == (rows, columns)
            assert np.array_equal(np.unique(found.labels), np.arange(found.count))
            assert segments == "auto" or found.count <= segments
            assert (found.labels.dtype, found.confidence.dtype) == (np.int32, np.float32)
            assert 0 <= found.confidence.min() <= found.confidence.max() <= 1

    def test_labels_of_any_type_and_scale_are_the_same(self):
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
    def test_non_finite_value_is_refused_with_its_place(self, value: float):
        picture = halves((20, 30), 50, 150) / 255
        picture[3, 5] = value
        with pytest.raises(PictureError, match="the first at row 3, column 5"):
            Gradient().segment(picture)

    def test_one_flat_colour_is_skipped(self):
        flat = np.full((20, 30, 3), (10, 200, 30), np.uint8)
        assert Gradient().skip(Views(left=flat)) == "the picture is one flat colour"
        flat[7, 9, 1] += 1
        assert Gradient().skip(Views(left=flat)) is None
        assert "one segment is requested" in Gradient(segments=1).skip(Views(left=flat))

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
        with pytest.raises(OptionError):
            Gradient(**options)

    def test_thresholds_out_of_order_are_explained(self):
        with pytest.raises(OptionError, match=r"flat 1\.4 < canny_low 5 <= canny_high 4 must hold"):
            Gradient(canny_low=5)

    def test_method_pickled_is_equal(self):
        method = Gradient(segments=3)
        assert pickle.loads(pickle.dumps(method)) == method
