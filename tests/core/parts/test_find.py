"""Connected parts of a picture, and the stability of their numbers."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import find_parts, part_sizes, reduced_parts

SMALL = arrays.arrays(np.int32, arrays.array_shapes(min_dims=2, max_dims=2, max_side=9), elements=st.integers(0, 3))


def parts_of(labels) -> np.ndarray:
    return find_parts(SegmentMap(np.asarray(labels, np.int32))).labels


def flood(labels: np.ndarray) -> np.ndarray:
    """Number the parts by filling each from its first pixel, row by row."""
    numbers = np.full(labels.shape, -1, np.int32)
    count = 0
    for start in np.ndindex(labels.shape):
        if numbers[start] >= 0:
            continue
        waiting = [start]
        while waiting:
            row, column = place = waiting.pop()
            if not (0 <= row < labels.shape[0] and 0 <= column < labels.shape[1]) or numbers[place] >= 0:
                continue
            if labels[place] == labels[start]:
                numbers[place] = count
                waiting += [(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)]
        count += 1
    return numbers


@given(SMALL)
def test_parts_equal_those_of_a_flood_fill(labels):
    parts = find_parts(SegmentMap(labels))
    assert np.array_equal(parts.labels, flood(labels))
    assert parts.labels.dtype == np.int32
    assert parts.segments == tuple(int(labels[parts.labels == part][0]) for part in range(parts.count))
    assert part_sizes(parts).tolist() == [np.count_nonzero(parts.labels == part) for part in range(parts.count)]


@given(SMALL, st.integers(1, 4), st.permutations(range(4)))
def test_part_numbers_do_not_depend_on_size_or_segment_labels(labels, times, order):
    parts = parts_of(labels)
    assert np.array_equal(
        parts_of(np.kron(labels, np.ones((times, times), np.int32))), parts.repeat(times, 0).repeat(times, 1)
    )
    assert np.array_equal(parts_of(np.asarray(order, np.int32)[labels]), parts)


def test_corners_do_not_connect_parts():
    assert parts_of([[0, 1], [1, 0]]).tolist() == [[0, 1], [2, 3]]


def test_coarser_grid_keeps_numbers_and_parts():
    labels = np.zeros((40, 60), np.int32)
    labels[:, 30:] = 1
    labels[5, 7] = 2  # between the middle pixels
    parts = find_parts(SegmentMap(labels))
    few = reduced_parts(parts, (4, 6))
    assert few.segments == parts.segments
    assert few.labels[0, 0] == parts.labels[5, 7]
    few_of_both = np.where(few.labels == parts.labels[5, 7], 0, few.labels)
    assert np.array_equal(few_of_both, parts.labels[:4, 27:33])
    assert reduced_parts(parts, (40, 60)) is parts


def test_coarser_grid_has_middle_pixels_and_a_cell_for_what_lies_between_them():
    """Whatever the numbers of rows and columns: specks at the rim and inside of it, and a part without any pixel."""
    labels = np.arange(35)[:, None] // 20 * 2 + np.arange(90) // 40
    specks = {(0, 0): (0, 0), (0, 89): (0, 9), (34, 1): (6, 0), (34, 89): (6, 9), (11, 62): (2, 6), (19, 35): (3, 3)}
    for place in specks:
        labels[place] = 9
    labels[11, 62:66] = 9  # of one part, whose first pixel counts
    parts = find_parts(SegmentMap(labels.astype(np.int32)))
    few = reduced_parts(PartMap(parts.labels, (*parts.segments, 99)), (7, 10))
    expected = parts.labels[2::5, 4::9].copy()
    for place, cell in specks.items():
        expected[cell] = parts.labels[place]
    assert np.array_equal(few.labels, expected)
    assert few.segments == (*parts.segments, 99) and parts.count == 6 + len(specks)
