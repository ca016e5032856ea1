"""Segments by a hierarchy, on pictures of a known answer."""

from itertools import pairwise

import cv2
import numpy as np
import pytest

from label_maps import rand_index
from tangible_core.data import Views
from tangible_core.errors import OptionError, PictureError
from tangible_core.plugins.notes import collected
from tangible_texture import Hierarchy
from tangible_texture.regions.basins import MOST_SEGMENTS
from wavy_cells import cells

COLOURS = np.array(
    [(200, 60, 50), (60, 150, 70), (60, 80, 190), (220, 200, 90), (30, 30, 35), (235, 235, 230), (140, 90, 160)]
)


def things(seed: int = 0, size: int = 256, noise: float = 6) -> tuple[np.ndarray, np.ndarray]:
    """Return a picture of wavy cells, each of one colour with noise in it, and its true labels."""
    labels = cells(seed, count=len(COLOURS), size=size)
    rng = np.random.default_rng(seed)
    picture = rng.permutation(COLOURS)[labels] + rng.normal(0, noise, (size, size, 3))
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8), labels


class TestHierarchy:
    @pytest.mark.parametrize("seed", range(3))
    def test_things_of_other_colours_are_found(self, seed: int):
        picture, truth = things(seed)
        found = Hierarchy().segment(picture)
        assert rand_index(found.labels, truth) >= 0.97
        assert found.count == truth.max() + 1

    @pytest.mark.parametrize("seed", range(4))
    def test_number_requested_is_found_at_the_true_borders(self, seed: int):
        picture, truth = things(seed, noise=20)
        found = Hierarchy(segments=len(COLOURS)).segment(picture)
        assert found.count == len(COLOURS)
        assert rand_index(found.labels, truth) >= 0.97

    def test_things_of_one_colour_and_other_roughness_are_found(self):
        rng = np.random.default_rng(0)
        picture = np.clip(128 + rng.normal(0, 2, (160, 200, 1)) + np.zeros(3), 0, 255)
        picture[:, 100:] += rng.normal(0, 45, (160, 100, 1))
        truth = np.zeros((160, 200), np.int32)
        truth[:, 100:] = 1
        found = Hierarchy(segments=2).segment(np.clip(picture, 0, 255).astype(np.uint8))
        assert rand_index(found.labels, truth) >= 0.9

    @pytest.mark.parametrize("noise", [4, 20, 60])
    def test_noise_is_one_segment(self, noise: float):
        grey = 128 + np.random.default_rng(0).normal(0, noise, (120, 160))
        assert Hierarchy().segment(np.clip(grey, 0, 255).astype(np.uint8)).count == 1

    def test_noise_is_not_divided_on_request(self):
        grey = 128 + np.random.default_rng(0).normal(0, 20, (120, 160))
        assert Hierarchy(segments=6).segment(np.clip(grey, 0, 255).astype(np.uint8)).count == 1

    def test_shading_is_one_segment(self):
        assert Hierarchy().segment(np.linspace(0, 255, 300)[None].repeat(200, axis=0).astype(np.uint8)).count == 1

    @pytest.mark.parametrize("factor", [2, 3])
    def test_enlarged_picture_has_the_same_regions(self, factor: int):
        picture, truth = things(1)
        large = cv2.resize(picture, None, fx=factor, fy=factor, interpolation=cv2.INTER_CUBIC)
        found = Hierarchy().segment(large)
        assert found.count == truth.max() + 1
        assert rand_index(found.labels, np.kron(truth, np.ones((factor, factor), np.int32))) >= 0.97

    def test_borders_are_finer_than_a_cell(self):
        """A cell is 3.5 pixels wide here."""
        picture = np.full((600, 800, 3), (200, 60, 50), np.uint8)
        picture[:, 407:] = 60, 80, 190
        found = Hierarchy().segment(picture)
        assert found.count == 2
        assert np.abs((found.labels == 0).sum(axis=1) - 407).max() <= 2

    @pytest.mark.parametrize("flip", [np.s_[::-1], np.s_[:, ::-1]], ids=["upside down", "mirrored"])
    def test_flipped_picture_has_flipped_regions(self, flip: tuple[slice, ...]):
        picture, _ = things(2)
        assert rand_index(Hierarchy().segment(picture[flip]).labels[flip], Hierarchy().segment(picture).labels) >= 0.99

    def test_lower_level_keeps_the_borders_and_adds_others(self):
        picture, _ = things(0, noise=30)
        coarse, fine = (Hierarchy(level=level).segment(picture).labels for level in (0.5, 0.1))
        pairs = np.unique(np.stack([fine.ravel(), coarse.ravel()]), axis=1)
        assert fine.max() > coarse.max()
        assert pairs.shape[1] == fine.max() + 1

    def test_every_cut_of_the_tree_divides_the_one_before(self):
        tree = Hierarchy().tree(things(0)[0])
        cuts = [tree.cut(count).labels for count in range(1, 30)]
        assert [int(each.max()) + 1 for each in cuts] == list(range(1, 30))
        for coarse, fine in pairwise(cuts):
            assert np.unique(np.stack([fine.ravel(), coarse.ravel()]), axis=1).shape[1] == fine.max() + 1

    def test_levels_of_a_tree_rise(self):
        levels = Hierarchy().tree(things(0, noise=40)[0]).levels
        assert np.all(np.diff(levels) >= 0)
        assert np.any(np.diff(levels) == 0), "some joining cost less than the one before"

    def test_weak_border_is_kept_at_a_low_level_alone(self):
        """People do not agree about a faint shadow."""
        picture = np.full((90, 120, 3), (120, 110, 100), np.uint8)
        picture[:, 60:] = 150, 140, 130
        picture[:20, :20] = 250, 20, 20
        counts = [Hierarchy(level=level).segment(picture).count for level in (0.13, 0.5)]
        assert counts == [3, 2]

    def test_level_is_the_confidence_of_segments(self):
        picture, truth = things(0)
        found = Hierarchy().segment(picture)
        assert found.confidence.min() > 0.5
        assert np.unique(found.confidence[truth == 0]).size == 1

    def test_estimate_is_noted_with_the_weakest_level(self):
        with collected() as notes:
            found = Hierarchy().segment(things(0)[0])
        worth = found.confidence.min()
        assert notes == [
            f"segments: {found.count}, estimated with confidence {worth:.2f}: "
            "the level of the weakest border between two segments"
        ]

    def test_estimate_is_limited(self):
        """A hundred squares of other colours."""
        numbers = np.kron(np.arange(100).reshape(10, 10) * 37 % 100, np.ones((20, 20), int))
        colours = np.random.default_rng(0).permutation(np.indices((5, 5, 4)).reshape(3, -1).T * [60, 60, 80])
        picture = colours[numbers].astype(np.uint8)
        assert Hierarchy(segments=200).segment(picture).count > MOST_SEGMENTS
        assert Hierarchy(level=0.02).segment(picture).count == MOST_SEGMENTS == 64

    def test_large_request_does_not_divide_what_nobody_would(self):
        picture = np.full((80, 120, 3), (200, 60, 50), np.uint8)
        picture[:, 60:] = 60, 80, 190
        assert Hierarchy(segments=50).segment(picture).count == 2

    def test_picture_of_one_colour_is_skipped(self):
        flat = Views(np.full((9, 9, 3), 7, np.uint8))
        assert Hierarchy().skip(flat) == "the picture is one flat colour"
        assert "one segment is requested" in (Hierarchy(segments=1).skip(Views(things()[0])) or "")
        assert Hierarchy().skip(Views(things()[0])) is None
        assert Hierarchy().segment(flat.left).count == 1

    def test_array_that_is_not_a_picture_is_refused(self):
        for segments in (1, "auto"):
            with pytest.raises(PictureError):
                Hierarchy(segments=segments).segment(np.full((9, 9), np.nan))

    @pytest.mark.parametrize("level", [0, 1, -0.1, 0.01])
    def test_level_outside_of_its_bounds_is_refused(self, level: float):
        with pytest.raises(OptionError):
            Hierarchy(level=level)
