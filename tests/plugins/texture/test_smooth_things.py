"""Segments of smooth things and seen borders: else pictures are cut where nobody would."""

from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import drawn_parts
from benchmarks.regions import covering
from label_maps import rand_index
from onnx_models import mono
from tangible_bench.metrics.segments import contingency
from tangible_core import Pipeline, Scene
from tangible_networks.fetching import add_network
from tangible_networks.store import known_networks
from tangible_texture import Hierarchy
from tangible_texture.gradient import Gradient
from tangible_texture.histogram import MAX_LEVELS, Histogram, OtsuClasses
from tangible_texture.regions.refining import remove_small_parts
from tangible_texture.regions.watershed import MAX_SEGMENTS
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
    @pytest.mark.parametrize("noise", [0, 12])
    @pytest.mark.parametrize("seed", range(2))
    def test_smooth_cells_are_found(self, seed: int, noise: float):
        picture, truth = smooth_scene(seed, noise)
        found = Gradient().segment(picture)
        assert rand_index(found.labels, truth) >= 0.98
        assert found.count == truth.max() + 1

    @pytest.mark.parametrize("seed", range(2))
    def test_weak_edges_are_found_in_noise(self, seed: int):
        """Steps of 9 grey levels in noise of 9, which hides them at sigma_px itself."""
        truth = cells(seed)
        rng = np.random.default_rng(seed)
        grey = 100 + 9.0 * rng.permutation(truth.max() + 1)[truth] + rng.normal(0, 9, truth.shape)
        assert rand_index(Gradient().segment(np.rint(grey).astype(np.uint8)).labels, truth) >= 0.95

    @pytest.mark.parametrize(("left", "right", "noise"), [(90, 140, 0), (90, 140, 8), (100, 101, 0), (0, 255, 3)])
    def test_boundary_of_two_halves_is_exact(self, left: float, right: float, noise: float):
        found = Gradient().segment(halves((80, 120), left, right, noise))
        assert found.count == 2
        assert np.all(np.abs(column_of_change(found.labels) - 60) <= 1)

    def test_gradient_separates_colours_and_rough_objects(self):
        picture = np.zeros((60, 80, 3))
        picture[:, :40] = 0.7, 0.3, 0.3
        picture[:, 40:, 1] = (0.7 * 0.299 + 0.3 * 0.587) / 0.587  # the same luma, all of it green
        picture[:, 40:, 2] = 0.3
        found = Gradient().segment(picture)
        assert np.array_equal(found.labels, np.repeat([[0, 1]], 40, axis=1).repeat(60, axis=0))
        assert Gradient(colour=False).segment(picture).count == 1
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

    def test_gradient_stops_at_its_bound_with_confidence_falling_to_edges(self):
        levels = np.random.default_rng(0).permutation(np.linspace(0, 255, 144)).reshape(12, 12)
        picture = np.kron(levels, np.ones((24, 24))).astype(np.uint8)
        assert Gradient().segment(picture).count == MAX_SEGMENTS
        assert Gradient(segments=144, sigma_px=1.5).segment(picture).count > 120
        confidence = Gradient().segment(halves((60, 120), 60, 160)).confidence
        assert np.all(confidence[:, :50] == 1)
        assert np.allclose(confidence[:, 59:61], 0, atol=1e-6)
        assert np.all(np.diff(confidence[:, 50:60], axis=1) <= 0)

    @pytest.mark.parametrize("seed", range(2))
    @pytest.mark.parametrize("shape", [(64, 64), (200, 120), (96, 96, 3)])
    def test_noise_is_one_segment(self, seed: int, shape: tuple[int, ...]):
        rng = np.random.default_rng(seed)
        assert Gradient().segment(rng.normal(0.5, 0.1, shape)).count == 1
        assert Gradient().segment(rng.normal(120, 6, shape).astype(np.uint8)).count == 1


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
    @pytest.mark.parametrize("seed", range(2))
    def test_things_of_other_colours_are_found_in_the_number_requested(self, seed: int):
        picture, truth = things(seed)
        found = Hierarchy().segment(picture)
        assert rand_index(found.labels, truth) >= 0.97
        assert found.count == truth.max() + 1
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

    def test_hierarchy_keeps_fine_borders_by_their_level(self):
        """A cell is 3.5 pixels wide here."""
        picture = np.full((600, 800, 3), (200, 60, 50), np.uint8)
        picture[:, 407:] = 60, 80, 190
        found = Hierarchy().segment(picture)
        assert found.count == 2
        assert np.abs((found.labels == 0).sum(axis=1) - 407).max() <= 2
        picture = np.full((90, 120, 3), (120, 110, 100), np.uint8)
        picture[:, 60:] = 150, 140, 130
        picture[:20, :20] = 250, 20, 20
        counts = [Hierarchy(level=level).segment(picture).count for level in (0.13, 0.5)]
        assert counts == [3, 2]
        picture, truth = things(0)
        found = Hierarchy().segment(picture)
        assert found.confidence.min() > 0.5
        assert np.unique(found.confidence[truth == 0]).size == 1

    def test_tree_has_a_cut_for_each_number_up_to_the_limit(self):
        tree = Hierarchy().tree(things(0)[0])
        cuts = [tree.cut(count).labels for count in range(1, 30)]
        assert [int(cut.max()) + 1 for cut in cuts] == list(range(1, 30))
        for coarse, fine in pairwise(cuts):
            assert np.unique(np.stack([fine.ravel(), coarse.ravel()]), axis=1).shape[1] == fine.max() + 1
        numbers = np.kron(np.arange(100).reshape(10, 10) * 37 % 100, np.ones((20, 20), int))
        colours = np.random.default_rng(0).permutation(np.indices((5, 5, 4)).reshape(3, -1).T * [60, 60, 80])
        picture = colours[numbers].astype(np.uint8)
        assert Hierarchy(segments=200).segment(picture).count > MAX_SEGMENTS
        assert Hierarchy(level=0.02).segment(picture).count == MAX_SEGMENTS == 64


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

    def test_classes_are_the_humps_of_the_counts(self):
        levels = np.arange(256.0)
        for counts in (np.full(256, 9), np.rint(9999 * np.exp(-(((levels - 128) / 30) ** 2) / 2)).astype(int) + 1):
            assert OtsuClasses(levels, counts, MAX_LEVELS).clearest() == (1, 1.0)
        humps = sum(np.exp(-(((levels - mean) / 5) ** 2) / 2) for mean in (40, 110, 200))
        number, ratio = OtsuClasses(levels, np.rint(9999 * humps).astype(int) + 1, MAX_LEVELS).clearest()
        assert number == 3
        assert ratio < 0.2


class TestSmallParts:
    CLASSES = np.array([[0, 0, 0, 1], [0, 1, 0, 1], [0, 0, 0, 1]], np.int32)
    LEVEL = np.zeros((3, 4), np.float32)

    def test_small_parts_go_to_adjacent_classes_and_edges_are_none(self):
        assert remove_small_parts(self.CLASSES, self.LEVEL, 1, 3).tolist() == [[0, 0, 0, 1]] * 3
        assert remove_small_parts(self.CLASSES, self.LEVEL, 1, 4).tolist() == [[0] * 4] * 3
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

    def test_confidence_is_the_distance_to_the_threshold(self):
        picture = np.repeat([[0.0, 0.4, 0.6, 1.0]], 30, axis=1).repeat(40, axis=0)
        confidence = Histogram(segments=2, sigma_px=0, smallest_px=1).segment(picture).confidence
        assert np.allclose(confidence[:, :30], 1)  # 0.5 away, where the class spreads by 0.2
        assert np.allclose(confidence[:, 30:90], 0.25)


def scene() -> np.ndarray:
    """A grey corner on a dark ground, and a bright line, which is what a network of brightness sees."""
    picture = np.zeros((120, 160, 3), np.uint8)
    picture[:40, :60] = 120
    picture[:, 100:102] = 255
    return picture


def test_network_decides_which_borders_people_would_draw(models: Path) -> None:
    before = Pipeline(Scene.photo(scene()), texture=Hierarchy()).segments
    mono(models / "own.onnx")
    (models / "own.yaml").write_text("task: borders\noutput: {means: borders}\n")
    within = Pipeline(Scene.photo(scene()), texture=Hierarchy())
    left, right = within.segments.labels[:, :98], within.segments.labels[:, 104:]
    assert len({before.labels[place] for place in ((10, 10), (100, 10), (60, 150))}) == 3
    assert (left == 0).all(), "the corner belongs to the ground"
    assert (right == 1).all()
    why = {outcome.product: outcome.why for outcome in within.outcomes}["segments"]
    assert "borders: seen by the network own" in why
    assert Hierarchy().reads() == (models / "own.onnx",)
    (models / "own.onnx").unlink()
    after = Pipeline(Scene.photo(scene()), texture=Hierarchy(), cached=False).segments
    assert np.array_equal(after.labels, before.labels)
    assert np.array_equal(after.confidence, before.confidence)


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (3, 5), (200, 1)])
def test_network_sees_pictures_of_any_size(models: Path, shape: tuple[int, int]) -> None:
    mono(models / "own.onnx")
    (models / "own.yaml").write_text("task: borders\noutput: {means: borders}\n")
    picture = np.arange(shape[0] * shape[1], dtype=np.uint16).reshape(shape) * 300
    assert Hierarchy().segment(picture).labels.shape == shape


@pytest.mark.nightly
def test_published_network_finds_what_people_drew(models: Path) -> None:
    drawings = [drawn_parts.drawn(name) for name in ("astronaut", "camera", "chelsea", "coffee", "rocket")]

    def cover() -> list[float]:
        found = [Hierarchy().segment(drawing.picture).labels for drawing in drawings]
        return [covering(contingency(*pair)) for pair in zip(found, (d.parts.labels for d in drawings), strict=True)]

    before = cover()
    add_network(known_networks()["hed"])
    assert (np.subtract(cover(), before) > 0.05).all()
