"""The segmenter by texture on mosaics: else textures are not told apart, or flat areas are."""

import cv2
import numpy as np
import pytest

from label_maps import rand_index
from tangible_core.plugins.notes import collected
from tangible_texture.clusters.flat_areas import flat_areas
from tangible_texture.energies.gabor_bank import Gabor as bank_filter
from tangible_texture.energies.gabor_bank import kernel, sigma_of_bandwidth
from tangible_texture.gabor import Gabor

EFFORTS = ["fast", "balanced"]


def waves(shape: tuple[int, int], wavelength_px: float, degrees: float, seed: int) -> np.ndarray:
    """Return noise of about one wavelength and direction, of mean 0.5 and standard deviation 0.15."""
    filtered = cv2.filter2D(
        np.random.default_rng(seed).standard_normal(shape),
        -1,
        kernel(bank_filter(wavelength_px, np.radians(degrees), sigma_of_bandwidth(wavelength_px, 1.5), 1.0)).real,
    )
    return 0.5 + 0.15 * (filtered - filtered.mean()) / filtered.std()


def mosaic(rows: int = 192, columns: int = 256) -> tuple[np.ndarray, np.ndarray]:
    """Return three textures of one brightness and contrast, with a curved and a straight border, and their labels."""
    row, column = np.indices((rows, columns))
    truth = np.where(column < columns * 0.45 + 12 * np.sin(row / 20), 0, np.where(row < rows * 0.55, 1, 2))
    textures = [waves((rows, columns), *each) for each in ((6, 20, 1), (6, 110, 2), (13, 65, 3))]
    return np.choose(truth, textures).clip(0, 1), truth.astype(np.int32)


PICTURE, TRUTH = mosaic()


@pytest.mark.parametrize("effort", EFFORTS)
def test_textures_of_one_brightness_are_separated(effort: str):
    found = Gabor(segments=3, effort=effort).segment(PICTURE)
    assert found.count == 3
    assert rand_index(TRUTH, found.labels) > 0.93
    across = found.labels[:, 1:] != found.labels[:, :-1]
    assert found.confidence[:, 1:][across].mean() < found.confidence.mean() - 0.1


def two_tints(picture: np.ndarray) -> np.ndarray:
    """Return the same grey everywhere, tinted red on the left and blue on the right."""
    red = np.where(np.arange(picture.shape[1]) < picture.shape[1] // 2, 0.3, -0.3)
    return np.stack([picture + red, picture, picture - red * 0.299 / 0.114], axis=2) / 2 + 0.25


def test_colour_is_used_where_it_differs_between_windows():
    grain = waves((128, 160), 6, 20, 1)
    picture = np.clip(two_tints(0.5 + (grain - 0.5) * 0.2), 0, 1)
    with collected() as notes:
        found = Gabor(segments=2).segment(picture)
    assert any(note.startswith("colour used") for note in notes)
    truth = np.broadcast_to(np.arange(160) // 80, (128, 160))
    assert rand_index(truth, found.labels) > 0.95
    with collected() as notes:
        Gabor(segments=3).segment(np.stack([PICTURE, PICTURE, PICTURE * 0.999], axis=2))
    assert any(note.startswith("colour left out") and "of white, under 0.02" in note for note in notes)


def test_labels_are_the_same_with_fewer_filters_or_one_thread(monkeypatch: pytest.MonkeyPatch):
    enlarged = cv2.GaussianBlur(cv2.resize(PICTURE, None, fx=3, fy=3, interpolation=cv2.INTER_CUBIC), (0, 0), 2)
    with collected() as notes:
        some = Gabor(segments=3).segment(enlarged)
    assert any(note.startswith("6 of 24 filters left out") for note in notes)
    with collected() as notes:
        every = Gabor(segments=3, least_energy=0).segment(enlarged)
    assert not any("filters left out" in note for note in notes)
    assert rand_index(some.labels, every.labels) > 0.95
    whole = Gabor(segments=3).segment(PICTURE)
    monkeypatch.setattr("tangible_core.compiled.threads.thread_count", lambda: 1)
    alone = Gabor(segments=3).segment(PICTURE)
    np.testing.assert_array_equal(whole.labels, alone.labels)
    np.testing.assert_array_equal(whole.confidence, alone.confidence)


def halves(left: int, right: int, sigma: float = 0.0) -> np.ndarray:
    picture = np.full((256, 256), float(left))
    picture[:, 128:] = right
    noise = np.random.default_rng(3).normal(0, sigma, picture.shape) if sigma else 0.0
    return np.clip(np.round(picture + noise), 0, 255).astype(np.uint8)


def quarters(*tones: int) -> np.ndarray:
    return np.repeat(np.repeat(np.array(tones, np.uint8).reshape(2, 2), 128, axis=0), 128, axis=1)


ROW, COLUMN = np.indices((256, 256))
FLAT = {
    "halves": (halves(60, 200), 2),
    "faint halves": (halves(100, 110), 2),
    "halves with noise of a sensor": (halves(60, 200, 3.0), 2),
    "one tone with noise of a sensor": (halves(90, 90, 2.0), 1),
    "quarters of four tones": (quarters(60, 200, 130, 250), 4),
    "quarters of three tones": (quarters(60, 200, 130, 60), 3),
    "disc": (np.where(np.hypot(ROW - 128, COLUMN - 128) < 64, 200, 60).astype(np.uint8), 2),
    "halves of one brightness": (np.stack([halves(150, 60), halves(80, 126), halves(60, 60)], axis=2), 2),
    "blurred edge": (np.clip(60 + 14 * (COLUMN - 123), 60, 200).astype(np.uint8), 2),
    "gradient": (COLUMN.astype(np.uint8), 1),
    "gradient along the diagonal": (((ROW + COLUMN) // 2).astype(np.uint8), 1),
}


@pytest.mark.parametrize(("picture", "areas"), FLAT.values(), ids=FLAT)
def test_flat_areas_are_as_many_as_there_are_tones(picture: np.ndarray, areas: int):
    assert Gabor().segment(picture).count == areas


@pytest.mark.parametrize("half", [PICTURE, np.where(np.arange(256) < 128, PICTURE, 0.9)], ids=["textures", "half flat"])
def test_textures_are_no_flat_areas(half: np.ndarray):
    assert flat_areas(half, True, 16) is None
