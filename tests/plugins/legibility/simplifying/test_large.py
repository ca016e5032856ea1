"""Segments merged into few large parts."""

import numpy as np
import pytest

from tangible_core.data import SegmentMap
from tangible_core.errors import PictureError
from tangible_core.parts import find_parts
from tangible_legibility.simplifying.large import disc_widths, large_parts

RED, ROSE, BLUE = (200, 30, 30), (210, 60, 60), (30, 30, 200)


def in_three(rows: int = 30, columns: int = 60) -> tuple[SegmentMap, np.ndarray]:
    """Return thirds of red, rose and blue, from left to right."""
    third = np.arange(columns) * 3 // columns
    labels = np.tile(third.astype(np.int32), (rows, 1))
    return SegmentMap(labels), np.array((RED, ROSE, BLUE), np.uint8)[labels]


def test_speck_joins_its_most_similar_neighbour():
    segments, picture = in_three()
    labels = segments.labels.copy()
    labels[10:13, 38:42] = 3
    picture[10:13, 38:42] = ROSE
    merged = large_parts(SegmentMap(labels), picture, least_px=6, most=12)
    assert merged.count == 3
    assert (merged.labels[10:13, 38:42] == merged.labels[0, 30]).all(), "half of it lies in the blue, all of it is rose"
    unmerged = large_parts(SegmentMap(labels), picture, least_px=2, most=12)
    assert unmerged.count == 4, "it is as wide as a part must be"


@pytest.mark.parametrize(("columns", "joins"), [(slice(18, 26), 39), (slice(14, 22), 0)])
def test_speck_of_a_colour_between_joins_along_its_longest_border(columns: slice, joins: int):
    """Two of its eight columns are on one side, and six on the other."""
    labels = np.repeat([[0, 1]], 20, axis=1).repeat(30, 0).astype(np.int32)
    labels[10:13, columns] = 2
    picture = np.array([(60, 60, 60), (140, 140, 140), (100, 100, 100)], np.uint8)[labels]
    merged = large_parts(SegmentMap(labels), picture, least_px=6, most=12)
    assert merged.count == 2
    assert (merged.labels[11, columns] == merged.labels[0, joins]).all()


def test_part_as_wide_as_the_least_is_no_speck():
    labels = np.zeros((30, 40), np.int32)
    labels[10:15, 10:15] = 1
    (_, width_px) = disc_widths(find_parts(SegmentMap(labels)))
    picture = np.full((30, 40, 3), 99, np.uint8)
    assert large_parts(SegmentMap(labels), picture, least_px=width_px, most=12).count == 2
    assert large_parts(SegmentMap(labels), picture, least_px=width_px + 0.1, most=12).count == 1


def test_small_part_joins_before_large_ones_that_are_more_alike():
    """What counts is the spread of colours that a pair adds, and few pixels add little."""
    labels = np.repeat([0, 1, 2], [30, 30, 3]).astype(np.int32)[None].repeat(20, 0)
    picture = np.array([(100,) * 3, (112,) * 3, (130,) * 3], np.uint8)[labels]
    merged = large_parts(SegmentMap(labels), picture, least_px=2, most=2)
    assert (merged.labels == np.array([0, 1, 1])[labels]).all()


def test_specks_that_are_large_together_become_one_part():
    rows, columns = np.indices((40, 40)) // 4
    mosaic = (rows * 10 + columns).astype(np.int32)
    picture = np.random.default_rng(1).integers(0, 255, (100, 3)).astype(np.uint8)[mosaic]
    merged = large_parts(SegmentMap(mosaic), picture, least_px=8, most=100)
    assert 1 < merged.count < 100 and (disc_widths(merged) >= 8).all()


def test_most_similar_parts_join_when_there_are_too_many():
    segments, picture = in_three()
    merged = large_parts(segments, picture, least_px=2, most=2)
    assert merged.count == 2
    assert (merged.labels == np.array([0, 0, 1])[segments.labels]).all(), "red and rose are one"
    assert large_parts(segments, picture, least_px=2, most=1).count == 1


def test_colour_counts_as_much_as_lightness():
    segments, _ = in_three()
    picture = np.array([(208, 68, 68), (119, 119, 119), (144, 144, 144)], np.uint8)[segments.labels]
    merged = large_parts(segments, picture, least_px=2, most=2)
    assert (merged.labels == np.array([0, 1, 1])[segments.labels]).all(), "a red and a grey of one lightness stay apart"


def test_part_numbers_follow_first_pixels_at_any_resolution():
    rng = np.random.default_rng(3)
    coarse = rng.integers(0, 6, (6, 8)).astype(np.int32)
    labels = np.repeat(np.repeat(coarse, 5, axis=0), 5, axis=1)
    picture = rng.integers(0, 255, (6, 8, 3)).astype(np.uint8)[np.arange(30) // 5][:, np.arange(40) // 5]
    merged = large_parts(SegmentMap(labels), picture, least_px=4, most=7)
    again = find_parts(SegmentMap(merged.labels))
    assert (again.labels == merged.labels).all() and again.count == merged.count == 7

    def twice(values: np.ndarray) -> np.ndarray:
        return np.repeat(np.repeat(values, 2, axis=0), 2, axis=1)

    larger = large_parts(SegmentMap(twice(labels)), twice(picture), least_px=8, most=7)
    assert (larger.labels == twice(merged.labels)).all()


@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (40, 1), (3, 3)])
def test_picture_narrower_than_a_speck_is_one_part(shape: tuple[int, int]):
    labels = np.arange(shape[0] * shape[1]).reshape(shape).astype(np.int32)
    assert large_parts(SegmentMap(labels), np.zeros(shape, np.uint8), least_px=5, most=12).count == 1


def test_disc_width_is_the_width_of_a_stripe():
    labels = np.zeros((40, 60), np.int32)
    labels[:, 20:] = 1
    assert disc_widths(find_parts(SegmentMap(labels))) == pytest.approx([20, 40], abs=1.5)


def test_picture_of_another_size_is_refused():
    segments, picture = in_three()
    with pytest.raises(PictureError, match="must be of one size"):
        large_parts(segments, picture[:-1], least_px=5, most=12)
