"""Segments merged into few large parts: if a case fails, a speck remains a part, or joins the wrong one."""

import numpy as np
import pytest

from tangible_core.data import SegmentMap
from tangible_legibility.simplifying.large import large_parts

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
    labels = np.repeat([[0, 1]], 20, axis=1).repeat(30, 0).astype(np.int32)
    labels[10:13, columns] = 2
    picture = np.array([(60, 60, 60), (140, 140, 140), (100, 100, 100)], np.uint8)[labels]
    merged = large_parts(SegmentMap(labels), picture, least_px=6, most=12)
    assert merged.count == 2
    assert (merged.labels[11, columns] == merged.labels[0, joins]).all()


def test_small_part_joins_before_large_ones_that_are_more_alike():
    """What counts is the spread of colours that a pair adds, and few pixels add little."""
    labels = np.repeat([0, 1, 2], [30, 30, 3]).astype(np.int32)[None].repeat(20, 0)
    picture = np.array([(100,) * 3, (112,) * 3, (130,) * 3], np.uint8)[labels]
    merged = large_parts(SegmentMap(labels), picture, least_px=2, most=2)
    assert (merged.labels == np.array([0, 1, 1])[labels]).all()


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
