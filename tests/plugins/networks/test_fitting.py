"""Sizes, numbers and meanings of a network's pictures and maps; else its relief is shifted or upside down."""

import numpy as np
import pytest

from tangible_core.data import Views
from tangible_networks.card import NetworkInput
from tangible_networks.fitting import Fit, fit_size, map_in_strips, restore_size, tensor, to_disparity

PAD, RESIZE = NetworkInput(multiple=32), NetworkInput(multiple=14, fit="resize")


@pytest.mark.parametrize(
    ("shape", "takes", "most_px", "fit"),
    [
        ((40, 50), PAD, 10_000, ((40, 50), (64, 64))),
        ((64, 96), PAD, 64 * 96, ((64, 96), (64, 96))),
        ((200, 400), PAD, 20_000, ((100, 200), (128, 224))),
        ((100, 141), RESIZE, 100_000, ((98, 140), (98, 140))),
        ((105, 3), RESIZE, 100_000, ((112, 14), (112, 14))),
        ((100, 50), NetworkInput(size_px=(48, 64)), 10, ((48, 64), (48, 64))),
    ],
)
def test_size_is_below_the_limit_and_a_multiple(shape, takes: NetworkInput, most_px: int, fit):
    assert fit_size(shape, takes, most_px) == Fit(*fit)


def test_picture_is_padded_by_its_last_row_and_column():
    picture = np.arange(18, dtype=np.float32).reshape(2, 3, 3)
    made = tensor(picture, NetworkInput(), Fit((2, 3), (3, 5)))
    assert made.shape == (1, 3, 3, 5)
    assert made[0, 0].tolist() == [[0, 3, 6, 6, 6], [9, 12, 15, 15, 15], [9, 12, 15, 15, 15]]


def test_map_loses_its_padding_and_leading_dimensions():
    fit, values = Fit((2, 3), (3, 5)), np.arange(15, dtype=np.float32).reshape(3, 5)
    for output in (values, values[None], values[None, None], values[None, ..., None]):
        found = restore_size(output, fit, (2, 3))
        assert found is not None
        assert found.tolist() == [[0, 1, 2], [5, 6, 7]]
    for output in (np.zeros((2, 3, 5)), np.zeros((1, 2, 3, 5)), np.zeros(5), np.zeros((0, 5))):
        assert restore_size(output, fit, (2, 3)) is None


def test_map_of_half_the_size_is_enlarged_with_its_padding():
    values = np.float32([[1, 1, 9, 9]] * 4)
    found = restore_size(values, Fit((8, 4), (8, 8)), (8, 4))
    assert found is not None
    assert found[:, :3].tolist() == [[1, 1, 1]] * 8


@pytest.mark.parametrize(
    ("height", "most_px", "multiple", "strips"),
    [
        (96, 960, 32, [(0, 96)]),
        (97, 990, 32, [(0, 96), (1, 97)]),
        (200, 1190, 32, [(0, 96), (72, 168), (104, 200)]),
        (150, 10, 1, [(0, 64), (48, 112), (86, 150)]),
    ],
)
def test_strips_overlap_and_have_the_rows_of_a_multiple(height: int, most_px: int, multiple: int, strips):
    seen = []

    def work(rows: slice) -> list[np.ndarray]:
        seen.append((rows.start, rows.stop))
        return [np.full((rows.stop - rows.start, 10), 7, np.float32)]

    (found,) = map_in_strips((height, 10), most_px, multiple, work)
    assert seen == strips
    assert found == pytest.approx(np.full((height, 10), 7))


def test_strips_fade_into_each_other():
    """No step between two rows is larger than that of a line over the overlap of 16 rows."""
    maps = iter([1.0, 2.0])
    (found,) = map_in_strips((112, 4), 4, 1, lambda rows: [np.full((64, 4), next(maps), np.float32)])
    assert (found[0, 0], found[-1, 0]) == (1, 2)
    assert np.flatnonzero(np.diff(found[:, 0]) > 0).tolist() == list(range(47, 64))
    assert np.diff(found[:, 0]).max() == pytest.approx(1 / 17, abs=1e-5)


VIEWS = Views(np.zeros((1, 4), np.uint8))
NAN = np.nan


@pytest.mark.parametrize(
    ("means", "numbers", "wanted"),
    [
        ("depth", [1, 2, 0, -1], [1, 0, NAN, NAN]),
        ("depth-m", [4, 2, 0, np.inf], [0, 1, NAN, NAN]),
        ("inverse-depth", [-3, -1, 0, 1], [0, 0.5, 0.75, 1]),
        ("inverse-depth", [2, 6, NAN, 4], [0, 1, NAN, 0.5]),
        ("disparity-px", [-2, 0, NAN, 5], [-2, 0, NAN, 5]),
        ("inverse-depth", [1, 1 + 2e-7, 1, 1], [0, 0, 0, 0]),
        ("depth", [NAN, NAN, 0, -1], [NAN] * 4),
    ],
)
def test_numbers_become_nearness_or_pixels(means, numbers, wanted):
    found = to_disparity(np.float32([numbers]), None, means, VIEWS)
    assert found.disparity_px.tolist() == [pytest.approx(wanted, nan_ok=True)]
    assert found.confidence.tolist() == [[float(not np.isnan(each)) for each in wanted]]
    assert found.unit == ("px" if means == "disparity-px" else "relative")


def test_confidence_is_a_share_and_none_where_nothing_is_known():
    found = to_disparity(np.float32([[1, 2, 3, NAN]]), np.float32([[0.25, 7, NAN, 0.5]]), "inverse-depth", VIEWS)
    assert found.confidence.tolist() == [[0.25, 1, 0, 0]]
