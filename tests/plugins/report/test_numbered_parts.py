"""The picture with numbered parts: if a case fails, a person names the wrong part, or cannot read its number."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import find_parts
from tangible_legibility.cells import largest_disc
from tangible_report.numbered_parts import LONGEST_PX, SHORTEST_PX, Before, Drawn, _coarse, numbered_parts


def draw(picture: np.ndarray, labels: np.ndarray, names: tuple[str, ...] = ()) -> np.ndarray:
    parts = find_parts(SegmentMap(labels.astype(np.int32)))
    return np.asarray(Image.open(BytesIO(numbered_parts(picture, parts, names))))


def halves(rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    labels = (np.arange(columns) * 2 // columns) * np.ones((rows, 1), int)
    return np.full((rows, columns, 3), 127, np.uint8), labels


@pytest.mark.parametrize("size", [(80, 100), pytest.param((3000, 4000), marks=pytest.mark.whole)])
def test_numbers_have_the_same_share_of_any_picture(size: tuple[int, int]):
    shown = draw(*halves(*size))
    longer = max(shown.shape)
    assert SHORTEST_PX <= longer <= LONGEST_PX and shown.shape[1] / shown.shape[0] == pytest.approx(size[1] / size[0])
    left = (shown[:, : shown.shape[1] * 2 // 5] != 127).any(axis=2)
    heights = np.flatnonzero(left.any(axis=1))
    assert 1 / 60 < np.ptp(heights) / longer < 1 / 15, "the number 0 in the middle of the left half"
    assert heights.mean() / shown.shape[0] == pytest.approx(0.5, abs=0.02)


def test_borders_are_visible_on_black_and_white():
    picture, labels = halves(600, 800)
    for grey in (0, 255):
        row = draw(np.full_like(picture, grey), labels)[5]
        middle = len(row) // 2
        assert {0, 255} <= set(row[middle - 10 : middle + 10].ravel().tolist())
        assert (row[: middle - 20] == grey).all()


def test_names_are_written_if_there_is_room():
    picture, labels = halves(600, 800)
    labels[:30, :30] = 2  # a part too small for its name
    plain, named = draw(picture, labels), draw(picture, labels, ("corner of the wall", "helmet", ""))

    def count_ink(shown: np.ndarray, columns: slice) -> int:
        return int((shown[:, columns] == 0).all(axis=2).sum())

    left, right = slice(100, plain.shape[1] // 2 - 40), slice(plain.shape[1] // 2 + 40, None)
    assert count_ink(named, left) > 3 * count_ink(plain, left), "1 helmet"
    assert count_ink(named, right) == count_ink(plain, right), "no name, its number alone"
    assert (named[:60, :60] == plain[:60, :60]).all(), "its number alone"


def parts(*rows: list[int]) -> PartMap:
    labels = np.int32(rows)
    return PartMap(labels, tuple(range(int(labels.max()) + 1)))


def test_parts_are_the_same_that_cover_most_of_each_other():
    drawn = Drawn(np.int32([[0, 0, 0, 1]]))
    assert drawn.before(parts([0, 0, 0, 1])) == (Before(0, 0), Before(1, 1))
    assert drawn.before(parts([0, 0, 1, 2])) == (Before(0, 0), Before(None, 0), Before(1, 1))
    assert drawn.before(parts([0, 0, 0, 0])) == (Before(0, 0),)
    assert Drawn(np.int32([[1, 1]])).before(parts([1, 1])) == (Before(None, 0), Before(1, 1))


def test_parts_of_another_shape_are_of_another_picture():
    assert Drawn(np.int32([[0, 0, 1, 1]])).before(parts([0], [0], [1], [1])) is None


def test_coarse_grid_has_the_middles_of_its_cells():
    assert _coarse(np.arange(12, dtype=np.int32)[None], 4).tolist() == [[1, 4, 7, 10]]


def test_number_of_a_bar_is_in_its_middle():
    bar = np.zeros((20, 60), bool)
    bar[3:8, 10:51] = True
    disc = largest_disc(bar)
    assert disc is not None
    assert (disc.column, disc.row) == (30, 5)
