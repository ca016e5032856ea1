"""If one of these fails, parts are joined, lost or numbered anew when a picture is enlarged."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy import ndimage

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import find_parts, part_sizes, reduced_parts

SMALL = arrays.arrays(np.int32, arrays.array_shapes(min_dims=2, max_dims=2, max_side=9), elements=st.integers(0, 3))


def parts_of(labels) -> np.ndarray:
    return find_parts(SegmentMap(np.asarray(labels, np.int32))).labels


def flood(labels: np.ndarray) -> np.ndarray:
    """Number the regions of each label, by SciPy, in the order of their first pixels."""
    regions = np.zeros(labels.shape, int)
    for label in np.unique(labels):
        of_label, _ = ndimage.label(labels == label)
        regions += (of_label > 0) * (of_label + regions.max())
    _, first, places = np.unique(regions, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[places].reshape(labels.shape)


@given(SMALL)
def test_parts_equal_the_regions_of_each_label(labels):
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
