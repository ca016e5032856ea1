"""If one of these fails, a part is felt without its rim, its middle or its height, or a wrong height is accepted."""

import numpy as np
import pytest

from drawn_parts import drawn
from tangible_core.data import PartMap, SegmentMap
from tangible_core.errors import GeometryError, PictureError
from tangible_core.parts import HeightChoice, Layering, find_parts
from tangible_core.parts.layering import border_distance

GIVEN = HeightChoice(by="given")
PLAIN = HeightChoice(by="given", detail_m=0)


def parts_of(labels) -> PartMap:
    return find_parts(SegmentMap(np.asarray(labels, np.int32)))


def disc(radius_px: float, side: int = 120) -> np.ndarray:
    """Return labels of a disc of 1 on a ground of 0, in the middle of the picture."""
    row, column = np.indices((side, side)) - (side - 1) / 2
    return (row**2 + column**2 < radius_px**2).astype(np.int32)


def test_distance_is_to_the_nearest_border():
    row, column = np.indices((40, 60))
    walls = (column >= 11).astype(np.int32) + (column >= 50) + (row >= 30)
    expected = np.minimum(np.minimum(np.abs(column - 10.5), np.abs(column - 49.5)), np.abs(row - 29.5))
    assert np.array_equal(border_distance(parts_of(walls)), expected)


def test_part_rises_from_its_height_by_a_quarter_of_a_circle():
    halves = np.zeros((4, 200), np.int32)
    halves[:, 100:] = 1
    profile = Layering(parts_of(halves), 0.2, PLAIN).relief([0, 0.003]).height_m[2].astype(float)
    assert np.all(profile[:100] == 0)
    from_border_m = np.minimum((np.arange(100) + 0.5) * 0.001 / 0.006, 1)
    assert profile[100:] == pytest.approx(0.003 + 0.0015 * np.sqrt(1 - (1 - from_border_m) ** 2), abs=1e-8)


def test_detail_stays_off_the_borders_and_within_its_height():
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
    relief = Layering(parts_of(np.zeros(shape)), 0.08, GIVEN, np.zeros(shape)).relief([0.003])
    assert np.all(relief.height_m == np.float32(0.003))
    assert relief.extent_m == pytest.approx((0.08, 0.08 * shape[0] / shape[1]))


@pytest.mark.parametrize("picture", [np.full((60, 60), np.nan, np.float32), np.zeros((60, 61), np.uint8)])
def test_picture_that_does_not_fit_the_parts_is_refused(picture):
    with pytest.raises(PictureError):
        Layering(parts_of(disc(20, 60)), 0.08, GIVEN, picture)


@pytest.mark.parametrize(
    ("heights_m", "message"),
    [([0.001], "2 parts and 1 heights"), ([0, np.nan], "part 2"), ([-0.001, 0], "part 1"), ([0, np.inf], "part 2")],
)
def test_wrong_heights_are_refused(heights_m, message):
    with pytest.raises(GeometryError, match=message):
        Layering(parts_of(disc(20, 60)), 0.08, GIVEN).relief(heights_m)
