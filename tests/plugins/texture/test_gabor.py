"""The segmenter by texture, on mosaics of two or three generated textures."""

import cv2
import numpy as np
import pytest

from label_maps import rand_index
from tangible_core.data import Views
from tangible_core.errors import OptionError, PictureError
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


def test_labels_are_in_the_order_of_their_first_pixels():
    labels = Gabor(segments=3).segment(PICTURE).labels
    firsts = [np.flatnonzero(labels == label)[0] for label in range(3)]
    assert firsts == sorted(firsts)


@pytest.mark.parametrize("effort", EFFORTS)
@pytest.mark.parametrize(
    "change",
    [
        lambda picture: picture * 1e20,
        lambda picture: picture * 1e-20,
        lambda picture: np.repeat(picture[..., None], 3, axis=2),
        lambda picture: np.dstack([picture] * 3 + [np.ones_like(picture)]),
    ],
    ids=["x 1e20", "x 1e-20", "RGB", "RGBA"],
)
def test_labels_of_any_scale_and_kind_of_picture_are_the_same(change, effort: str):
    method = Gabor(segments=3, effort=effort)
    np.testing.assert_array_equal(method.segment(change(PICTURE)).labels, method.segment(PICTURE).labels)


@pytest.mark.parametrize("effort", EFFORTS)
@pytest.mark.parametrize(("gain", "offset"), [(0.3, 0.5), (0.31, 0.25), (0.37, 0.4)])
def test_labels_under_gain_and_offset_change_by_rounding_only(gain: float, offset: float, effort: str):
    # Both are rounded: of half a million comparisons with neighbours one or two come out the other way.
    method = Gabor(segments=3, effort=effort)
    changed = method.segment((PICTURE * gain + offset).astype(np.float32)).labels
    assert np.mean(changed != method.segment(PICTURE).labels) <= 1e-3


def test_labels_of_eight_and_sixteen_bits_are_the_same():
    eight = np.rint(PICTURE * 255).astype(np.uint8)
    one, other = (Gabor(segments=3).segment(each).labels for each in (eight, eight.astype(np.uint16) * 257))
    np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("effort", EFFORTS)
@pytest.mark.parametrize(
    ("there", "back"),
    [(np.fliplr, np.fliplr), (np.flipud, np.flipud), (np.rot90, lambda each: np.rot90(each, -1)), (np.transpose,) * 2],
    ids=["left and right", "up and down", "quarter turn", "transposed"],
)
def test_labels_of_a_flipped_or_turned_picture_move_along(there, back, effort: str):
    method = Gabor(segments=3, effort=effort)
    turned = back(method.segment(np.ascontiguousarray(there(PICTURE))).labels)
    assert rand_index(method.segment(PICTURE).labels, turned) >= 0.995


def test_labels_in_noise_change_little():
    noisy = PICTURE + 8 / 255 * np.random.default_rng(5).standard_normal(PICTURE.shape)
    assert rand_index(Gabor(segments=3).segment(PICTURE).labels, Gabor(segments=3).segment(noisy).labels) >= 0.95


def checkerboard(side_px: int) -> np.ndarray:
    row, column = np.indices((128, 160))
    return ((row // side_px + column // side_px) % 2 * 255).astype(np.uint8)


def one_pixel_brighter() -> np.ndarray:
    picture = np.full((128, 160), 77, np.uint8)
    picture[50, 60] += 1
    return picture


@pytest.mark.parametrize("segments", [1, 2, 5, 64, "auto"])
@pytest.mark.parametrize(
    "picture",
    [np.full((128, 160), 0.3), one_pixel_brighter(), checkerboard(1), checkerboard(4), checkerboard(7)],
    ids=["constant", "one pixel + 1", "squares of 1 px", "of 4 px", "of 7 px"],
)
def test_one_texture_is_one_segment_for_any_request(picture: np.ndarray, segments: int | str):
    assert Gabor(segments=segments).segment(picture).count == 1


def test_segments_are_not_more_than_distinct_features():
    halves = np.hstack([checkerboard(2), checkerboard(8)])
    assert 2 <= Gabor(segments=3).segment(halves).count <= 3


@pytest.mark.parametrize(
    "shape", [(1, 1), (1, 2), (2, 1), (1, 17), (9, 1), (3, 3), (5, 7), (17, 9), (40, 3), (33, 131)]
)
@pytest.mark.parametrize("segments", [2, 64, "auto"])
def test_labels_of_any_size_are_sound(shape: tuple[int, int], segments: int | str):
    picture = np.random.default_rng(3).random(shape)
    found = Gabor(segments=segments).segment(picture)
    assert found.labels.shape == found.confidence.shape == shape
    assert np.array_equal(np.unique(found.labels), np.arange(found.count))
    assert segments == "auto" or found.count <= segments
    assert 0 <= found.confidence.min() <= found.confidence.max() <= 1


def test_frame_of_the_picture_is_not_a_segment():
    """Waves that wrapped around the frame would make a strip of another texture along it."""
    picture, _ = mosaic()
    picture[:, 128:] = waves((192, 128), 13, 65, 4)
    picture[:, :128] = waves((192, 128), 6, 20, 5)
    labels = Gabor(segments=2).segment(picture).labels
    assert np.all(labels[:, :110] == 0) and np.all(labels[:, 146:] == 1)


def two_tints(picture: np.ndarray) -> np.ndarray:
    """Return the same grey everywhere, tinted red on the left and blue on the right."""
    red = np.where(np.arange(picture.shape[1]) < picture.shape[1] // 2, 0.3, -0.3)
    return np.stack([picture + red, picture, picture - red * 0.299 / 0.114], axis=2) / 2 + 0.25


def test_colour_differing_between_windows_is_used():
    grain = waves((128, 160), 6, 20, 1)
    picture = np.clip(two_tints(0.5 + (grain - 0.5) * 0.2), 0, 1)
    with collected() as notes:
        found = Gabor(segments=2).segment(picture)
    assert any(each.startswith("colour used") for each in notes)
    truth = np.broadcast_to(np.arange(160) // 80, (128, 160))
    assert rand_index(truth, found.labels) > 0.95


def under_slanting_light(picture: np.ndarray) -> np.ndarray:
    """Return a picture redder from left to right, and bluer from top to bottom."""
    rows, columns = (np.linspace(-0.15, 0.15, side) for side in picture.shape)
    return np.stack([picture + columns, picture, picture + rows[:, None]], axis=2) / 1.5 + 0.15


@pytest.mark.parametrize(
    ("picture", "colour", "why"),
    [
        (PICTURE, "auto", "the picture has none"),
        (under_slanting_light(PICTURE), "auto", "of white, under 0.02"),
        (np.stack([PICTURE, PICTURE, PICTURE * 0.999], axis=2), "auto", "of white, under 0.02"),
    ],
)
def test_colour_without_information_is_left_out_and_reported(picture: np.ndarray, colour: str, why: str):
    with collected() as notes:
        Gabor(segments=3, colour=colour).segment(picture)
    assert any(each.startswith("colour left out") and why in each for each in notes)


def test_filters_above_the_bandwidth_are_left_out():
    enlarged = cv2.GaussianBlur(cv2.resize(PICTURE, None, fx=3, fy=3, interpolation=cv2.INTER_CUBIC), (0, 0), 2)
    with collected() as notes:
        some = Gabor(segments=3).segment(enlarged)
    assert any(each.startswith("6 of 24 filters left out") for each in notes)
    with collected() as notes:
        every = Gabor(segments=3, least_energy=0).segment(enlarged)
    assert not any("filters left out" in each for each in notes)
    assert rand_index(some.labels, every.labels) > 0.95


def test_auto_finds_three_and_reports_its_confidence():
    with collected() as notes:
        found = Gabor().segment(PICTURE)
    assert found.count == 3
    assert any(each.startswith("segments: 3, estimated with confidence 0.") for each in notes)


def test_flat_picture_or_one_segment_is_skipped():
    assert str(Gabor(segments=1).skip(Views(PICTURE))).startswith("one segment is requested")
    assert Gabor().skip(Views(np.full((4, 4), 0.5))) == "the picture is one flat colour"
    assert Gabor().skip(Views(PICTURE)) is None


def test_non_finite_value_is_named_with_its_place():
    picture = PICTURE.copy()
    picture[7, 9] = np.nan
    with pytest.raises(PictureError, match="row 7, column 9"):
        Gabor().segment(picture)


@pytest.mark.parametrize("options", [{"segments": 0}, {"effort": "most"}, {"lambda_max_px": 1}, {"least_energy": 1}])
def test_options_out_of_range_are_refused(options: dict):
    with pytest.raises(OptionError):
        Gabor(**options)


def test_labels_with_one_thread_are_the_same(monkeypatch: pytest.MonkeyPatch):
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


@pytest.mark.parametrize("effort", EFFORTS)
@pytest.mark.parametrize(("picture", "areas"), FLAT.values(), ids=FLAT)
def test_flat_areas_are_as_many_as_there_are_tones(picture: np.ndarray, areas: int, effort: str):
    assert Gabor(effort=effort).segment(picture).count == areas


def test_border_of_flat_areas_is_that_of_the_picture():
    labels = Gabor().segment(halves(200, 60)).labels
    assert np.array_equal(labels, np.repeat([[0] * 128 + [1] * 128], 256, axis=0))


@pytest.mark.parametrize("half", [PICTURE, np.where(np.arange(256) < 128, PICTURE, 0.9)], ids=["textures", "half flat"])
def test_textures_are_no_flat_areas(half: np.ndarray):
    assert flat_areas(half, True, 16) is None
