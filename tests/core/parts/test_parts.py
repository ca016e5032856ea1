"""If one of these fails, parts are joined, lost or renumbered, or felt at other heights than their own."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy import ndimage

from drawn_parts import drawn
from tangible_core.data import DisparityMap, PartMap, SegmentMap
from tangible_core.errors import GeometryError, PictureError
from tangible_core.parts import HeightChoice, Layering, depth_heights, find_parts, part_sizes, reduced_parts
from tangible_core.parts.depth import part_medians
from tangible_core.parts.layering import border_distance

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


VALUES = st.one_of(st.floats(width=32), st.sampled_from([0.0, -0.0, 1.0, -1.0, np.nan, np.inf, -np.inf]))


def stripes(*disparities_px: float, rows: int = 20, width: int = 10) -> tuple[PartMap, DisparityMap]:
    """Return parts side by side, each with one disparity."""
    labels = np.broadcast_to(np.arange(len(disparities_px)).repeat(width), (rows, width * len(disparities_px)))
    parts = find_parts(SegmentMap(labels.astype(np.int32)))
    return parts, DisparityMap(np.float32(disparities_px)[parts.labels])


@example(np.zeros((5, 6), np.int32), np.arange(30, dtype=np.float32).reshape(5, 6))  # an even number: two in the middle
@given(arrays.arrays(np.int32, (5, 6), elements=st.integers(0, 2)), arrays.arrays(np.float32, (5, 6), elements=VALUES))
def test_medians_are_those_of_the_finite_values_of_each_part(labels, values):
    parts = find_parts(SegmentMap(labels))
    medians, known = part_medians(parts, values)
    for part in range(parts.count):
        finite = values[(parts.labels == part) & np.isfinite(values)].astype(np.float64)
        assert known[part] == finite.size
        assert np.array_equal(medians[part], np.median(finite) if finite.size else np.nan, equal_nan=True)


def test_heights_are_linear_in_disparity_whatever_a_speck_has():
    assert depth_heights(*stripes(30, 10, 20), 0.004).heights_m == pytest.approx((0.004, 0, 0.002))
    parts, disparity = stripes(10, 20, 30)
    labels, values = parts.labels.copy(), disparity.disparity_px.copy()
    labels[5, 5], values[5, 5] = 3, 900
    heights = depth_heights(find_parts(SegmentMap(labels)), DisparityMap(values), 0.004)
    assert sorted(heights.heights_m) == pytest.approx([0, 0.002, 0.004, 0.004])


@pytest.mark.parametrize(("columns", "clipped"), [(4, True), (6, False)])
def test_heights_run_between_what_has_half_a_percent_of_the_picture_on_either_side(columns: int, clipped: bool):
    """Of 1000 columns, so many are much farther and so many much nearer than all others."""
    labels = np.searchsorted([columns, 300, 600, 1000 - columns], np.arange(1000), side="right")
    parts = find_parts(SegmentMap(np.tile(labels, (3, 1)).astype(np.int32)))
    disparity = DisparityMap(np.float32([-900, 10, 20, 40, 1000])[parts.labels])
    expected = (0, 0, 1 / 3, 1, 1) if clipped else (0, 91 / 190, 92 / 190, 94 / 190, 1)
    assert depth_heights(parts, disparity, 0.004).heights_m == pytest.approx([0.004 * each for each in expected])


def test_unknown_parts_lie_as_far_as_the_farthest_of_their_neighbours_one_after_the_other():
    """Three unknown parts in a row between 40 and 20 px, and one that is beside 10 and 30 px."""
    heights = depth_heights(*stripes(40, np.nan, np.nan, np.nan, 20, 30, np.nan, 10), 0.003).heights_m
    assert heights == pytest.approx((0.003, 0.003, 0.001, 0.001, 0.001, 0.002, 0, 0))


@pytest.mark.parametrize("disparity_px", [7.0, np.nan])
def test_equal_or_unknown_depths_give_heights_of_zero(disparity_px):
    assert depth_heights(*stripes(disparity_px, disparity_px), 0.004).heights_m == (0, 0)


GIVEN = HeightChoice(by="given")
PLAIN = HeightChoice(by="given", detail_m=0)


def part_map_of(labels) -> PartMap:
    return find_parts(SegmentMap(np.asarray(labels, np.int32)))


def disc(radius_px: float, side: int = 120) -> np.ndarray:
    """Return labels of a disc of 1 on a ground of 0, in the middle of the picture."""
    row, column = np.indices((side, side)) - (side - 1) / 2
    return (row**2 + column**2 < radius_px**2).astype(np.int32)


def test_part_rises_by_a_quarter_circle_and_its_detail_stays_off_the_border():
    row, column = np.indices((40, 60))
    walls = (column >= 11).astype(np.int32) + (column >= 50) + (row >= 30)
    expected = np.minimum(np.minimum(np.abs(column - 10.5), np.abs(column - 49.5)), np.abs(row - 29.5))
    assert np.array_equal(border_distance(part_map_of(walls)), expected)
    halves = np.zeros((4, 200), np.int32)
    halves[:, 100:] = 1
    profile = Layering(part_map_of(halves), 0.2, PLAIN).relief([0, 0.003]).height_m[2].astype(float)
    assert np.all(profile[:100] == 0)
    from_border_m = np.minimum((np.arange(100) + 0.5) * 0.001 / 0.006, 1)
    assert profile[100:] == pytest.approx(0.003 + 0.0015 * np.sqrt(1 - (1 - from_border_m) ** 2), abs=1e-8)
    picture, parts, _, heights_m = drawn("astronaut")
    with_detail, without = (Layering(parts, 0.16, each, picture).relief(heights_m).height_m for each in (GIVEN, PLAIN))
    detail = with_detail - without
    ground = np.float32(heights_m)[parts.labels] == 0
    assert np.abs(detail).max() <= GIVEN.detail_m / 2 + 1e-9
    assert detail[ground].min() == 0  # below which nothing sinks
    assert np.ptp(detail[~ground]) > 0.9 * GIVEN.detail_m
    at_border = border_distance(parts) < 1
    assert np.abs(detail[at_border]).max() < 0.15 * GIVEN.detail_m / 2
    assert with_detail.max() <= max(heights_m) + GIVEN.bulge_m + GIVEN.detail_m / 2 + 1e-8


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (5, 7)])
def test_single_part_is_flat_at_its_height(shape):
    relief = Layering(part_map_of(np.zeros(shape)), 0.08, GIVEN, np.zeros(shape)).relief([0.003])
    assert np.all(relief.height_m == np.float32(0.003))
    assert relief.extent_m == pytest.approx((0.08, 0.08 * shape[0] / shape[1]))


@pytest.mark.parametrize("picture", [np.full((60, 60), np.nan, np.float32), np.zeros((60, 61), np.uint8)])
def test_picture_that_does_not_fit_the_parts_is_refused(picture):
    with pytest.raises(PictureError):
        Layering(part_map_of(disc(20, 60)), 0.08, GIVEN, picture)


@pytest.mark.parametrize(
    ("heights_m", "message"),
    [([0.001], "2 parts and 1 heights"), ([0, np.nan], "part 2"), ([-0.001, 0], "part 1"), ([0, np.inf], "part 2")],
)
def test_wrong_heights_are_refused(heights_m, message):
    with pytest.raises(GeometryError, match=message):
        Layering(part_map_of(disc(20, 60)), 0.08, GIVEN).relief(heights_m)
