"""The report's chain and the torch variants, as methods, on pictures of a known answer."""

import sys

import numpy as np
import pytest

from label_maps import rand_index
from tangible_core.data import Views
from tangible_core.errors import TangibleError
from tangible_core.plugins.notes import collected
from tangible_texture.energies.gabor_bank import bank, octaves
from tangible_texture.energies.local_energy import energy_planes, padding, spectrum_of
from tangible_texture.energies.responses import even_responses
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

    def test_auto_reports_its_estimate(self):
        with collected() as notes:
            found = Report().segment(quarters()[0])
        assert f"segments: {found.count}, estimated with confidence" in " ".join(notes)

    def test_responses_are_convolutions_with_the_even_kernel(self):
        wave = np.cos(np.arange(100) * np.pi / 2).astype(np.float32)[None].repeat(90, axis=0)
        own, other = even_responses(wave, [bank((4.0,))[0], bank((9.0,))[0]])
        inner = (slice(30, -30), slice(30, -30))
        assert own[inner] == pytest.approx(wave[inner], abs=0.01)
        assert np.abs(other[inner]).max() < 0.01

    def test_labels_of_one_seed_repeat(self):
        grey = quarters()[0]
        one, two = (Report(segments=4, seed=5).segment(grey) for _ in range(2))
        assert one.digest() == two.digest()

    def test_faint_picture_is_segmented_too(self):
        grey = quarters()[0]
        faint = Report(segments=4, seed=1).segment(grey.astype(np.float32) / 255 * 1e-20)
        assert rand_index(faint.labels, quarters()[1]) > 0.9

    def test_features_exceeding_memory_are_thinned_and_reported(self):
        grey, truth = quarters(400)
        with collected() as notes:
            found = Report(segments=4, seed=1, memory_mb=16).segment(grey)
        assert any("features every 2 pixels only" in each for each in notes)
        assert found.labels.shape == (400, 400)
        assert rand_index(found.labels, truth) > 0.9

    def test_skip_weak_leaves_filters_out(self):
        grey, truth = quarters()
        with collected() as notes:
            found = Report(segments=4, frequencies="octaves", skip_weak=True, seed=1).segment(grey)
        assert any("filters left out" in each for each in notes)
        assert rand_index(found.labels, truth) > 0.9


class TestKorniaGabor:
    @pytest.mark.parametrize("step_px", [3, 4])
    def test_energies_match_the_fast_bank(self, step_px):
        import torch

        from tangible_texture.kornia_gabor_kernels import energies

        grey = np.random.default_rng(0).random((90, 77)).astype(np.float32)
        filters = bank(octaves(12))
        found = energies(grey, filters, step_px, 6.0, torch.device("cpu")).numpy()
        ours = energy_planes(spectrum_of(grey, padding(filters, 6.0)), filters, grey.shape, step_px, 6.0)
        assert (np.abs(found - ours).max(axis=(1, 2)) < 0.01 * ours.mean(axis=(1, 2))).all()

    def test_clusters_match_our_k_means(self):
        import torch

        from tangible_texture import kornia_gabor_kernels

        rng = np.random.default_rng(0)
        rows = (rng.normal(size=(5, 8))[rng.integers(0, 5, 2000)] * 8 + rng.normal(size=(2000, 8))).astype(np.float32)
        ours = kmeans(rows, 5, restarts=10)
        theirs = kornia_gabor_kernels.kmeans(torch.from_numpy(rows), 5, restarts=10)
        assert theirs.cost == pytest.approx(ours.cost, rel=1e-4)
        assert rand_index(theirs.labels.numpy(), ours.labels) == 1

    def test_clusters_are_not_more_than_distinct_rows(self):
        import torch

        from tangible_texture.kornia_gabor_kernels import kmeans

        assert len(kmeans(torch.zeros(9, 2), 4).centres) == 1
        assert len(kmeans(torch.eye(3).repeat(5, 1), 7, restarts=2).centres) == 3

    def test_labels_match_the_fast_bank_with_the_same_clustering(self):
        import torch

        from tangible_texture.kornia_gabor_kernels import standardise_roots

        grey, _ = quarters(256)
        found = KorniaGabor(segments=4, drop_seams=False, skip_octaves=False).segment(grey)
        filters = bank(octaves(16))
        planes = energy_planes(
            spectrum_of(grey.astype(np.float32), padding(filters, 12.0)), filters, grey.shape, 4, 12.0
        )
        rows = standardise_roots(torch.from_numpy(planes)).numpy()
        ours = kmeans(rows, 4, restarts=10).labels.reshape(64, 64).repeat(4, 0).repeat(4, 1)
        assert rand_index(found.labels, ours) > 0.95

    def test_four_textures_have_no_seams(self):
        grey, truth = quarters(256)
        found = KorniaGabor(segments=4).segment(grey)
        assert found.count == 4
        assert rand_index(found.labels, truth) > 0.9


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

    def test_noise_alone_is_one_segment(self):
        noise = np.random.default_rng(0).normal(128, 10, (100, 100))
        assert KorniaGradient().segment(np.clip(noise, 0, 255).astype(np.uint8)).count == 1

    def test_thresholds_out_of_order_are_refused(self):
        with pytest.raises(ValueError, match="canny_low 5 is above canny_high 4"):
            KorniaGradient(canny_low=5)


@pytest.mark.parametrize("method", METHODS, ids=NAMES)
def test_flat_colour_is_skipped(method):
    assert method.skip(Views(np.full((9, 9), 7, np.uint8))) == "the picture is one flat colour"
    assert method.skip(Views(quarters(20)[0])) is None


@pytest.mark.parametrize("method", METHODS[:2], ids=NAMES[:2])
@pytest.mark.parametrize("shape", [(1, 1), (17, 9), (2, 50)])
def test_segments_are_not_more_than_distinct_pixels(method, shape):
    picture = (np.indices(shape).sum(axis=0) % 2 * 200).astype(np.uint8)
    found = type(method)(segments=9).segment(picture)
    assert found.labels.shape == shape
    assert found.count <= min(9, picture.size)
    assert type(method)(segments=9).segment(np.full(shape, 50, np.uint8)).count == 1


@pytest.mark.parametrize(("method", "missing"), [(METHODS[1], "torch"), (METHODS[1], "kornia"), (METHODS[2], "kornia")])
def test_method_without_its_extra_names_the_installation(method, missing, monkeypatch):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(TangibleError, match=rf"{missing}.*pip install torch kornia"):
        method.segment(np.zeros((20, 20)))
