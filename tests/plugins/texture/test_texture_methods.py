"""The report's chain, the torch variants, and the options of all segmenters, on pictures of a known answer."""

import numpy as np
import pytest

from label_maps import rand_index
from tangible_core.data import Views
from tangible_core.errors import OptionError
from tangible_core.plugins.notes import collected
from tangible_texture import Gabor, Gradient, Hierarchy, Histogram
from tangible_texture.energies.gabor_bank import bank, octaves
from tangible_texture.energies.local_energy import energy_planes, even_responses, padding, picture_spectrum
from tangible_texture.kmeans.lloyd import kmeans
from tangible_texture.kornia_gabor import KorniaGabor
from tangible_texture.kornia_gradient import KorniaGradient
from tangible_texture.report import Report

METHODS = [Report(), KorniaGabor(), KorniaGradient()]
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

    def test_responses_are_convolutions_with_the_even_kernel(self):
        wave = np.cos(np.arange(100) * np.pi / 2).astype(np.float32)[None].repeat(90, axis=0)
        own, other = even_responses(wave, [bank((4.0,))[0], bank((9.0,))[0]])
        inner = (slice(30, -30), slice(30, -30))
        assert own[inner] == pytest.approx(wave[inner], abs=0.01)
        assert np.abs(other[inner]).max() < 0.01

    def test_features_exceeding_memory_are_thinned_and_reported(self):
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
