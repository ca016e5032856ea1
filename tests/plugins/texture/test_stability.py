"""Pictures that break segmenters, and the options of all: else a method fails or finds other segments."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
import pytest

from label_maps import rand_index
from tangible_core import load_method
from tangible_core.data import SegmentMap, Views
from tangible_core.errors import OptionError
from tangible_core.plugins.interfaces import Segmenter
from tangible_core.plugins.notes import collected
from tangible_core.plugins.registry import default_registry
from tangible_core.testing.checks import exact_variants
from tangible_core.testing.synthetic.scenes import two_textures
from tangible_texture import Gabor, Gradient, Hierarchy, Histogram
from tangible_texture.energies.gabor_bank import bank, octaves
from tangible_texture.energies.local_energy import energy_planes, even_responses, padding, picture_spectrum
from tangible_texture.kmeans.lloyd import kmeans
from tangible_texture.kornia_gabor import KorniaGabor
from tangible_texture.kornia_gradient import KorniaGradient
from tangible_texture.report import Report

METHODS = [
    listing.name
    for listing in default_registry().listings
    if (listing.kind, listing.distribution) == ("texture", "tangible-images")
]
SLOW_PEERS = {"kornia-gabor", "kornia-gradient", "report"}
"""Methods that others replace, and that take nine tenths of the time of all: in the nightly tests."""
OF_GREY = {"gradient", "hierarchy", "histogram", "kornia-gradient"}
"""The methods that separate by brightness. The others separate by texture, for which a checkerboard is one thing."""
SHAPE = 64, 88
NUMBERS = ("auto", 1, 2, 7, 1000)

by_method = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.nightly if name in SLOW_PEERS else ()) for name in METHODS]
)


def made(name: str, **options: Any) -> Segmenter | None:
    """Return a method; None if it has no such options: not every one has `auto`."""
    try:
        return load_method("texture", name)(**options)
    except OptionError:
        return None


def one_pixel(row: int, column: int) -> np.ndarray:
    picture = np.full(SHAPE, 128, np.uint8)
    picture[row, column] += 1
    return picture


def board(side_px: int) -> np.ndarray:
    rows, columns = np.indices(SHAPE) // side_px
    return np.where((rows + columns) % 2, 210, 40).astype(np.uint8)


def halves() -> np.ndarray:
    return np.where(np.indices(SHAPE)[1] < SHAPE[1] // 2, 60, 180).astype(np.uint8)


def two(shape: tuple[int, int] = (96, 128)) -> np.ndarray:
    return two_textures(shape)[0]


class Case(NamedTuple):
    """A picture, and the most segments that methods by grey and by texture may find; every map is `well_formed`."""

    picture: Callable[[], np.ndarray]
    of_grey: int
    of_texture: int


ANY = 1 << 30
CASES: Mapping[str, Case] = {
    "clear": Case(lambda: np.zeros((*SHAPE, 4), np.uint8), 1, 1),
    "constant of 1e20": Case(lambda: np.full(SHAPE, 1e20), 1, 1),
    "constant and negative": Case(lambda: np.full(SHAPE, -0.3), 1, 1),
    "constant but for one pixel": Case(lambda: one_pixel(30, 41), 1, 1),
    "constant but for a corner": Case(lambda: one_pixel(0, 0), 1, 1),
    "board of pixels": Case(lambda: board(1), 1, 1),
    "board of squares": Case(lambda: board(4), ANY, 1),  # to a method by grey each square is a thing
    "two levels": Case(halves, 2, ANY),  # to one by texture the step between is a third thing
    "two levels of bool": Case(lambda: halves() > 100, 2, ANY),
    "two textures": Case(two, ANY, ANY),
    "one row": Case(lambda: two((1, 17)), ANY, ANY),
    "few pixels": Case(lambda: two((5, 4)), ANY, ANY),
    "odd sides": Case(lambda: two((61, 97)), ANY, ANY),
}


def well_formed(found: SegmentMap, picture: np.ndarray) -> None:
    """Labels 0..n-1 without a gap, int32, contiguous, of the picture's size; confidence in 0..1."""
    labels, confidence = found.labels, found.confidence
    assert labels.shape == confidence.shape == picture.shape[:2]
    assert (labels.dtype, confidence.dtype) == (np.int32, np.float32)
    assert labels.flags.c_contiguous
    assert np.array_equal(np.unique(labels), np.arange(found.count))
    assert 0 <= confidence.min() <= confidence.max() <= 1


@by_method
@pytest.mark.parametrize("case", CASES)
def test_case_meets_its_demand(case: str, name: str):
    picture, of_grey, of_texture = CASES[case]
    for number in NUMBERS:
        method = made(name, segments=number)
        if method is not None:
            found = method.segment(picture())
            well_formed(found, picture())
            assert number == "auto" or found.count <= int(number)
            assert found.count <= (of_grey if name in OF_GREY else of_texture)


@by_method
def test_labels_under_gain_offset_and_any_kind_of_array_agree(name: str):
    method = load_method("texture", name)()
    expected = method.segment(two()).labels
    changed = [((two() / 255 + offset) * scale) for scale, offset in ((1e20, 0), (1e-20, 0.25), (-1, 0.25))]
    if name == "flat":  # by colours as they are seen, whose differences another gain makes larger or smaller
        changed = []
    for picture in [*changed, *(variant for _, variant in exact_variants(two()))]:
        assert rand_index(method.segment(picture).labels, expected) >= 0.98


@by_method
@pytest.mark.parametrize("upright", [True, False])
def test_borders_do_not_wrap_around(name: str, upright: bool):
    picture, truth = two_textures((120, 200))
    labels = load_method("texture", name)(segments=2).segment(picture if upright else picture.transpose(1, 0, 2)).labels
    labels = labels if upright else labels.T
    for side, half in ((np.s_[:, :8], truth == 0), (np.s_[:, -8:], truth == 1)):
        own = np.bincount(labels[half]).argmax()
        assert np.mean(labels[side] == own) >= 0.95


@by_method
def test_calls_in_parallel_do_not_disturb_each_other(name: str):
    method = load_method("texture", name)()
    pictures = [two(), two()[::-1].copy(), board(4)] * 2
    alone = [method.segment(picture).digest() for picture in pictures[:3]] * 2
    with ThreadPoolExecutor(3) as pool:
        assert [each.digest() for each in pool.map(method.segment, pictures)] == alone


OTHERS = [Report(), KorniaGabor(), KorniaGradient()]
NAMES = ["report", "kornia-gabor", "kornia-gradient"]


def quarters(size=160):
    """Return four textures of one mean and one contrast, and their labels."""
    rows, columns = np.indices((size, size))
    truth = 2 * (rows >= size // 2) + (columns >= size // 2)
    waves = [(1 / 4, 0), (0, 1 / 4), (1 / 8, 0), (0.1, 0.1)]
    grey = np.zeros((size, size))
    for label, (down, right) in enumerate(waves):
        grey[truth == label] = np.cos(2 * np.pi * (down * rows + right * columns))[truth == label]
    noise = np.random.default_rng(0).normal(0, 0.3, grey.shape)
    return np.clip(np.rint(128 + 40 * (grey + noise)), 0, 255).astype(np.uint8), truth


class TestReport:
    @pytest.mark.parametrize("frequencies", ["printed", "octaves"])
    def test_four_textures_are_found(self, frequencies):
        grey, truth = quarters()
        found = Report(segments=4, frequencies=frequencies, seed=1).segment(grey)
        assert found.count == 4
        assert rand_index(found.labels, truth) > 0.9
        assert found.confidence[40, 40] > 2 * found.confidence[80, 40]

    def test_responses_are_convolutions_and_thinned_within_memory(self):
        wave = np.cos(np.arange(100) * np.pi / 2).astype(np.float32)[None].repeat(90, axis=0)
        own, other = even_responses(wave, [bank((4.0,))[0], bank((9.0,))[0]])
        inner = (slice(30, -30), slice(30, -30))
        assert own[inner] == pytest.approx(wave[inner], abs=0.01)
        assert np.abs(other[inner]).max() < 0.01
        grey, truth = quarters(400)
        with collected() as notes:
            found = Report(segments=4, seed=1, memory_mb=16).segment(grey)
        assert any("features every 2 pixels only" in note for note in notes)
        assert found.labels.shape == (400, 400)
        assert rand_index(found.labels, truth) > 0.9


class TestKorniaGabor:
    def test_energies_match_the_fast_bank(self):
        import torch

        from tangible_texture.kornia_gabor_kernels import energies

        grey = np.random.default_rng(0).random((90, 77)).astype(np.float32)
        filters = bank(octaves(12))
        found = energies(grey, filters, 3, 6.0, torch.device("cpu")).numpy()
        ours = energy_planes(picture_spectrum(grey, padding(filters, 6.0)), filters, grey.shape, 3, 6.0)
        assert (np.abs(found - ours).max(axis=(1, 2)) < 0.01 * ours.mean(axis=(1, 2))).all()

    def test_clusters_match_our_k_means(self):
        import torch

        from tangible_texture import kornia_gabor_kernels

        rng = np.random.default_rng(0)
        rows = (rng.normal(size=(5, 8))[rng.integers(0, 5, 2000)] * 8 + rng.normal(size=(2000, 8))).astype(np.float32)
        ours = kmeans(rows, 5, restarts=10)
        labels, _, cost = kornia_gabor_kernels.kmeans(torch.from_numpy(rows), 5, restarts=10)
        assert cost == pytest.approx(ours.cost, rel=1e-4)
        assert rand_index(labels.numpy(), ours.labels) == 1

    @pytest.mark.whole
    def test_four_textures_have_no_seams(self):
        grey, truth = quarters(256)
        found = KorniaGabor(segments=4).segment(grey)
        assert found.count == 4
        assert rand_index(found.labels, truth) > 0.9


@pytest.mark.parametrize(
    ("cls", "options"),
    [
        (Gradient, {"segments": 0}),
        (Gradient, {"flat": 3.0}),
        (Gradient, {"canny_low": 5}),
        (KorniaGradient, {"canny_low": 5}),
        (Histogram, {"bins": 9}),
        (Hierarchy, {"level": 1}),
        (Gabor, {"segments": 0}),
        (Gabor, {"lambda_max_px": 1}),
    ],
)
def test_options_out_of_range_are_refused(cls, options):
    with pytest.raises(OptionError):
        cls(**options)


@pytest.mark.parametrize("cls", [Gradient, Hierarchy, Histogram, Gabor, Report, KorniaGabor, KorniaGradient])
def test_flat_colour_or_one_segment_is_skipped(cls):
    flat = Views(np.full((9, 9), 7, np.uint8))
    assert cls().skip(flat)
    assert cls(segments=1).skip(Views(quarters(20)[0]))
    assert cls().skip(Views(quarters(20)[0])) is None


class TestKorniaGradient:
    def test_areas_of_one_grey_are_found(self):
        rows, columns = np.indices((120, 140))
        truth = np.where(np.hypot(rows - 60, columns - 70) < 35, 1, 2 * (columns >= 110)).astype(np.int32)
        grey = np.array([60, 140, 220])[truth] + np.random.default_rng(0).normal(0, 4, truth.shape)
        picture = np.clip(np.rint(grey), 0, 255).astype(np.uint8)
        found = KorniaGradient().segment(picture)
        assert found.count == 3
        assert rand_index(found.labels, truth) > 0.98
        assert KorniaGradient(segments=2).segment(picture).count == 2
