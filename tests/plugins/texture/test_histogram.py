"""Thresholds of grey, against every possible division and on pictures of known levels."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import Views
from tangible_core.errors import OptionError
from tangible_core.plugins.notes import collected
from tangible_texture.clusters.otsu import OtsuClasses
from tangible_texture.histogram import MOST_LEVELS, Histogram
from tangible_texture.regions.small_parts import remove_small_parts


def spread(levels: np.ndarray, counts: np.ndarray, starts: tuple[int, ...]) -> float:
    """Return the sum of squares within classes, by its definition."""
    classes = np.searchsorted(starts, np.arange(levels.size), side="right")
    values, of = np.repeat(levels, counts), np.repeat(classes, counts)
    return float(sum(((values[of == each] - values[of == each].mean()) ** 2).sum() for each in np.unique(of)))


def bars(levels: np.ndarray, noise: float = 0.0, seed: int = 0) -> np.ndarray:
    """Return 8 bits of grey: vertical bars of these levels, 40 px wide each, with noise."""
    grey = np.repeat(levels, 40)[None].repeat(100, axis=0)
    return np.clip(np.rint(grey + np.random.default_rng(seed).normal(0, noise, grey.shape)), 0, 255).astype(np.uint8)


class TestOtsuClasses:
    @given(st.lists(st.integers(1, 30), min_size=1, max_size=9), st.integers(1, 9), st.integers(0, 99))
    def test_division_is_optimal(self, counts: list[int], classes: int, seed: int):
        levels, number = np.sort(np.random.default_rng(seed).random(len(counts))), np.array(counts)
        found = OtsuClasses(levels, number, classes)
        classes = len(found.spreads)
        every = [spread(levels, number, starts) for starts in combinations(range(1, levels.size), classes - 1)]
        assert found.spreads[-1] == pytest.approx(min(every), abs=1e-9)
        assert spread(levels, number, tuple(found.starts(classes)[1:])) == pytest.approx(min(every), abs=1e-9)

    @pytest.mark.parametrize("classes", [2, 3, 4])
    def test_thresholds_agree_with_scikit_image(self, classes: int):
        from skimage.filters import threshold_multiotsu

        picture = np.random.default_rng(0).integers(0, 64, (50, 50)) ** 2 // 16
        pixels = np.bincount(picture.ravel(), minlength=256)
        expected = threshold_multiotsu(hist=(pixels, np.arange(256.0)), classes=classes)
        used = np.flatnonzero(pixels)
        starts = used[OtsuClasses(used.astype(float), pixels[used], classes).starts(classes)][1:]
        assert [pixels[:start].sum() for start in starts] == [pixels[: int(each) + 1].sum() for each in expected]

    def test_levels_even_or_of_one_gaussian_are_one_class(self):
        levels = np.arange(256.0)
        for counts in (np.full(256, 9), np.rint(9999 * np.exp(-(((levels - 128) / 30) ** 2) / 2)).astype(int) + 1):
            assert OtsuClasses(levels, counts, MOST_LEVELS).clearest() == (1, 1.0)

    def test_humps_are_counted(self):
        levels = np.arange(256.0)
        humps = sum(np.exp(-(((levels - mean) / 5) ** 2) / 2) for mean in (40, 110, 200))
        number, ratio = OtsuClasses(levels, np.rint(9999 * humps).astype(int) + 1, MOST_LEVELS).clearest()
        assert number == 3
        assert ratio < 0.2


class TestSmallParts:
    CLASSES = np.array([[0, 0, 0, 1], [0, 1, 0, 1], [0, 0, 0, 1]], np.int32)
    LEVEL = np.zeros((3, 4), np.float32)

    def test_small_parts_go_to_adjacent_classes(self):
        assert remove_small_parts(self.CLASSES, self.LEVEL, 1, 3).tolist() == [[0, 0, 0, 1]] * 3
        assert remove_small_parts(self.CLASSES, self.LEVEL, 1, 4).tolist() == [[0] * 4] * 3

    def test_small_parts_alone_are_one_class(self):
        assert np.all(remove_small_parts(self.CLASSES, self.LEVEL, 1, 10) == 0)

    def test_edge_is_not_a_part(self):
        classes = np.array([[0, 0, 0, 1, 1, 2, 2, 2]] * 9, np.int32)
        steep = np.array([[0, 0, 2, 4, 5, 2, 0, 0]] * 9, np.float32)
        assert np.delete(remove_small_parts(classes, steep, 1, 9), 4, axis=1).tolist() == [[0] * 4 + [2] * 3] * 9


class TestHistogram:
    @pytest.mark.parametrize("noise", [0, 2, 6])
    @pytest.mark.parametrize("number", [2, 3, 5, 8])
    def test_bars_are_found(self, number: int, noise: float):
        levels = np.random.default_rng(number).permutation(np.linspace(20, 235, number))
        truth = np.repeat(np.arange(number), 40)[None].repeat(100, axis=0)
        for segments in ("auto", number):
            found = Histogram(segments=segments).segment(bars(levels, noise))
            assert found.count == number
            assert np.mean(found.labels == truth) >= 0.97

    def test_level_in_two_places_is_one_segment(self):
        labels = Histogram().segment(bars(np.array([50, 200, 50, 120]), 3)).labels
        assert labels[50, 20::40].tolist() == [0, 1, 0, 2]

    @pytest.mark.parametrize("segments", [2, 3, 7, 300])
    def test_segments_are_not_more_than_grey_levels(self, segments: int):
        for levels in ([60, 61], [0, 100, 255], [10, 11, 12, 13]):
            found = Histogram(segments=segments, sigma_px=0, smallest_px=1).segment(bars(np.array(levels)))
            assert found.count == min(segments, len(levels))
            assert Histogram(segments=segments).segment(bars(np.array(levels))).count <= len(levels)

    @given(st.integers(1, 20), st.integers(1, 20), st.integers(0, 9), st.sampled_from(["auto", 1, 2, 7, 10**6]))
    def test_labels_of_any_picture_are_sound(self, rows: int, columns: int, seed: int, segments: int | str):
        picture = np.random.default_rng(seed).integers(0, 6, (rows, columns), np.uint8) * np.uint8(40)
        for options in ({}, {"sigma_px": 0, "smallest_px": 1}):
            found = Histogram(segments=segments, **options).segment(picture)
            assert np.array_equal(np.unique(found.labels), np.arange(found.count))
            assert found.count <= np.unique(picture).size
            assert segments == "auto" or found.count <= segments
            assert 0 <= found.confidence.min() <= found.confidence.max() <= 1

    def test_noise_and_shading_are_one_segment(self):
        rng = np.random.default_rng(0)
        for picture in (rng.normal(120, 10, (90, 120)).astype(np.uint8), np.arange(200.0)[None].repeat(50, axis=0)):
            assert Histogram().segment(picture).count == 1

    def test_confidence_is_the_distance_to_the_threshold(self):
        picture = np.repeat([[0.0, 0.4, 0.6, 1.0]], 30, axis=1).repeat(40, axis=0)
        confidence = Histogram(segments=2, sigma_px=0, smallest_px=1).segment(picture).confidence
        assert np.allclose(confidence[:, :30], 1)  # 0.5 away, where the class spreads by 0.2
        assert np.allclose(confidence[:, 30:90], 0.25)

    def test_auto_reports_its_confidence(self):
        with collected() as notes:
            Histogram().segment(bars(np.array([40, 200]), 3))
        assert any(each.startswith("segments: 2, estimated with confidence 1.00") for each in notes), notes

    def test_one_segment_is_skipped(self):
        picture = bars(np.array([40, 200]))
        assert "one segment is requested" in Histogram(segments=1).skip(Views(picture))
        assert Histogram().skip(Views(np.full_like(picture, 7))) == "the picture is one flat colour"
        assert Histogram().skip(Views(picture)) is None

    @pytest.mark.parametrize("options", [{"segments": 0}, {"sigma_px": -1}, {"smallest_px": 0}, {"bins": 9}], ids=str)
    def test_wrong_options_are_refused(self, options: dict):
        with pytest.raises(OptionError):
            Histogram(**options)
