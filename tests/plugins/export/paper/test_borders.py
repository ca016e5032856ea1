"""Borders as shared lines: if a case fails, an outline leaves a gap, lies twice, or lies beside its part."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from tangible_core.data import PartMap, SegmentMap
from tangible_core.errors import GeometryError
from tangible_core.parts import find_parts
from tangible_export.paper.borders import shared_borders

SMALL = arrays.arrays(np.int32, arrays.array_shapes(min_dims=2, max_dims=2, max_side=8), elements=st.integers(0, 2))


def parts_of(labels) -> PartMap:
    return find_parts(SegmentMap(np.asarray(labels, np.int32)))


def in_pixels(labels, tolerance_px: float = 0) -> np.ndarray:
    """Return the polygons in a frame of one metre a pixel."""
    parts = parts_of(labels)
    return np.array(shared_borders(parts, float(parts.labels.shape[1]), tolerance_px))


def segments_of(polygons) -> list[bytes]:
    """Return the bytes of every straight piece of every line, its ends in order."""
    pieces: list[bytes] = []
    for ring in shapely.get_rings(shapely.get_parts(polygons)):
        at = shapely.get_coordinates(ring)
        ends = np.stack([at[:-1], at[1:]], axis=1)
        swap = (ends[:, 0, 0] > ends[:, 1, 0]) | ((ends[:, 0, 0] == ends[:, 1, 0]) & (ends[:, 0, 1] > ends[:, 1, 1]))
        ends[swap] = ends[swap][:, ::-1]
        pieces += [end.tobytes() for end in ends]
    return pieces


def check_whole(polygons, rows: int, columns: int) -> None:
    """Check for gaps, overlaps, lines that two parts do not share to the bit, and a rim that is not a rectangle."""
    assert shapely.is_valid(polygons).all()
    assert shapely.coverage_is_valid(polygons)
    assert shapely.area(polygons).sum() == pytest.approx(rows * columns, rel=1e-12)
    assert shapely.equals(
        shapely.coverage_union_all(polygons), shapely.box(-columns / 2, -rows / 2, columns / 2, rows / 2)
    )
    segments, times = np.unique(segments_of(polygons), return_counts=True)
    ends = np.frombuffer(b"".join(segments.tolist()), np.float64).reshape(-1, 2, 2)
    on_rim = (np.abs(ends) == (columns / 2, rows / 2)) & (ends[:, :1] == ends[:, 1:])
    assert np.array_equal(times, np.where(on_rim.any(axis=(1, 2)), 1, 2))


@given(SMALL, st.sampled_from([0, 0.4, 1, 3]))
def test_polygons_cover_the_picture_without_gap_and_overlap(labels, tolerance_px):
    polygons = in_pixels(labels, tolerance_px)
    check_whole(polygons, *labels.shape)
    sizes = np.bincount(parts_of(labels).labels.reshape(-1))
    if tolerance_px < 0.5:  # no triangle of the sides of pixels is that small
        assert shapely.area(polygons).tolist() == sizes.tolist()
        assert shapely.length(polygons).sum() == np.sum(
            [_sides(parts_of(labels).labels == part) for part in range(sizes.size)]
        )


def _sides(part: np.ndarray) -> int:
    around = np.pad(part, 1)
    return int((around[1:] != around[:-1]).sum() + (around[:, 1:] != around[:, :-1]).sum())


def test_polygons_are_in_metres_to_the_right_and_away_from_the_user():
    parts = parts_of([[0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 0]])
    assert shared_borders(parts, 0.08, 0)[1].bounds == pytest.approx((0, -0.01, 0.02, 0.01))
    parts = parts_of([[1, 0, 0, 0], [0, 0, 0, 0]])
    assert shared_borders(parts, 0.08, 0)[0].bounds == pytest.approx((-0.04, 0, -0.02, 0.02))


def test_holes_and_parts_inside_them_are_kept():
    ring = np.zeros((40, 60), np.int32)
    ring[5:35, 10:50] = 1
    ring[10:30, 20:30] = ring[10:30, 35:45] = 2
    for tolerance_px in (0, 2):
        polygons = in_pixels(ring, tolerance_px)
        assert shapely.get_num_interior_rings(polygons).tolist() == [1, 2, 0, 0]
        assert shapely.area(polygons).tolist() == [2400 - 1200, 1200 - 400, 200, 200]


def test_stairs_become_lines_within_the_tolerance():
    row, column = np.indices((200, 200)) - 99.5
    labels = (column > 0.37 * row).astype(np.int32)
    labels[column**2 + row**2 < 60**2] = 2
    plain, simple = in_pixels(labels), in_pixels(labels, 1.5)
    assert shapely.get_num_coordinates(simple).sum() < shapely.get_num_coordinates(plain).sum() / 4
    circle = shapely.Point(0, 0).buffer(60, quad_segs=64)
    disc = simple[np.argmin(np.abs(shapely.area(simple) - circle.area))]
    assert disc.boundary.hausdorff_distance(circle.boundary) < 1.5 + 0.75
    for before, after in zip(plain, simple, strict=True):
        assert before.boundary.hausdorff_distance(after.boundary) < 1.5


def test_part_of_several_pieces_or_none_is_a_geometry():
    parts = PartMap(np.int32([[2, 0, 2]]), (0, 1, 2))
    one, none, two = shared_borders(parts, 3.0, 0)
    assert (one.area, none.is_empty, two.geom_type, two.area) == (1, True, "MultiPolygon", 2)


@pytest.mark.parametrize(("width_m", "tolerance_m"), [(0, 0), (-1, 0), (np.nan, 0), (0.08, -1), (0.08, np.nan)])
def test_wrong_lengths_are_refused(width_m, tolerance_m):
    with pytest.raises(GeometryError, match="lengths in metres"):
        shared_borders(parts_of([[0, 1]]), width_m, tolerance_m)
