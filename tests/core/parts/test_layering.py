"""The relief of parts: borders, middle and ground, for any size and kind of picture."""

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


def enlarge(array: np.ndarray, times: int = 2) -> np.ndarray:
    return array.repeat(times, axis=0).repeat(times, axis=1)


def test_distance_to_a_straight_border_is_exact():
    halves = np.zeros((30, 50), np.int32)
    halves[:, 20:] = 1
    assert np.array_equal(border_distance(parts_of(halves))[7], np.abs(np.arange(50) - 19.5))


def test_distance_to_a_round_border_is_that_to_the_circle():
    row, column = np.indices((120, 120)) - 59.5
    off_px = border_distance(parts_of(disc(40))) - np.abs(np.hypot(row, column) - 40)
    assert np.abs(off_px).max() < 0.75  # half of a pixel's diagonal


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


def test_low_part_bulges_by_at_most_its_height():
    layering = Layering(parts_of(disc(40)), 0.08, PLAIN)
    ground, low, higher = (layering.relief([0, height]).height_m for height in (0, 1e-6, 0.0004))
    assert not ground.any()
    assert low.max() <= 2e-6
    assert higher.max() == np.float32(0.0008)
    assert np.array_equal(higher == 0, disc(40) == 0)


def test_height_changes_its_own_part_only():
    row, column = np.indices((40, 60))
    layering = Layering(parts_of((column >= 20).astype(int) + (column >= 40)), 0.08, GIVEN, (row * column / 2400))
    before, after = (layering.relief([0.001, height, 0.002]).height_m for height in (0, 0.004))
    changed = (before != after).any(axis=0)
    assert changed[20:40].all()
    assert not changed[:20].any()
    assert not changed[40:].any()


@pytest.mark.parametrize("by_hand", ["astronaut", "coffee"])
def test_relief_does_not_depend_on_the_resolution(by_hand):
    picture, parts, _, heights_m = drawn(by_hand)
    labels, (rows, columns) = parts.labels, parts.labels.shape
    once = Layering(parts, 0.08, GIVEN, picture).relief(heights_m).height_m
    twice = Layering(parts_of(enlarge(labels)), 0.08, GIVEN, enlarge(picture)).relief(heights_m).height_m
    mean = twice.reshape(rows, 2, columns, 2).mean(axis=(1, 3))  # over what is one pixel of the smaller picture
    around = np.lib.stride_tricks.sliding_window_view(np.pad(once, 1, mode="edge"), (3, 3)).reshape(rows, columns, 9)
    rim = np.where(border_distance(parts) < 1, np.float32(heights_m)[labels], np.inf)  # which lies within this pixel
    assert np.all(mean >= np.minimum(around.min(axis=2), rim) - 1e-5)
    assert np.all(mean <= around.max(axis=2) + 1e-5)
    assert np.median(np.abs(mean - once)) < 2e-6


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


def test_detail_does_not_depend_on_the_resolution():
    picture = np.kron(np.random.default_rng(0).integers(0, 255, (50, 80)), np.ones((16, 16))).astype(np.uint8)
    parts = parts_of(np.zeros(picture.shape))
    whole = Layering(parts, 0.08, GIVEN, picture).relief([0.001]).height_m
    few = Layering(parts_of(np.zeros((400, 640))), 0.08, GIVEN, picture[::2, ::2]).relief([0.001]).height_m
    assert np.abs(whole.reshape(400, 2, 640, 2).mean(axis=(1, 3)) - few).max() < 0.1 * GIVEN.detail_m


def as_kinds(grey: np.ndarray) -> dict[str, np.ndarray]:
    """Return the same picture in each dtype and number of channels."""
    colour = np.repeat(grey[..., None], 3, axis=2)
    opaque = np.full((*grey.shape, 1), 255, np.uint8)
    return {
        "uint8": grey,
        "uint16": grey.astype(np.uint16) * 257,
        "float32": (grey / np.float32(255)).astype(np.float32),
        "float64": grey / 255,
        "RGB": colour,
        "RGBA": np.concatenate([colour, opaque], axis=2),
    }


@pytest.mark.parametrize("kind", as_kinds(np.zeros((1, 1), np.uint8)))
def test_every_dtype_gives_the_same_relief(kind):
    grey = np.random.default_rng(0).integers(0, 255, (60, 60)).astype(np.uint8)
    layering = Layering(parts_of(disc(20, 60)), 0.08, GIVEN, as_kinds(grey)[kind])
    expected = Layering(parts_of(disc(20, 60)), 0.08, GIVEN, grey).relief([0, 0.002]).height_m
    height_m = layering.relief([0, 0.002]).height_m
    assert height_m.dtype == np.float32
    assert np.abs(height_m - expected).max() < 1e-8


def test_detail_exists_for_black_and_white_and_not_for_one_shade():
    plain = Layering(parts_of(disc(20, 60)), 0.08, GIVEN).relief([0, 0.002]).height_m
    shade = Layering(parts_of(disc(20, 60)), 0.08, GIVEN, np.full((60, 60, 3), 77, np.uint8)).relief([0, 0.002])
    assert np.array_equal(shade.height_m, plain)
    layering = Layering(parts_of(disc(20, 60)), 0.08, GIVEN, np.indices((60, 60))[0] % 16 < 8)
    assert np.ptp(layering.relief([0, 0.002]).height_m - plain) > 0


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (5, 7)])
def test_single_part_is_flat_at_its_height(shape):
    relief = Layering(parts_of(np.zeros(shape)), 0.08, GIVEN, np.zeros(shape)).relief([0.003])
    assert np.all(relief.height_m == np.float32(0.003))
    assert relief.extent_m == pytest.approx((0.08, 0.08 * shape[0] / shape[1]))


def test_relief_without_rounding_has_steps():
    steps = HeightChoice(by="given", round_m=0, detail_m=0)
    height_m = Layering(parts_of(disc(20, 60)), 0.08, steps).relief([0, 0.002]).height_m
    assert set(height_m.ravel().tolist()) == {0, float(np.float32(0.002) + np.float32(0.0015))}


@pytest.mark.parametrize(
    ("picture", "message"),
    [
        (np.full((60, 60), np.nan, np.float32), "NaN"),
        (np.zeros((60, 61), np.uint8), "61 x 60"),
        (np.zeros((60, 60, 2), np.uint8), "a picture is"),
        (np.zeros((0, 0), np.uint8), "at least one pixel"),
        (np.zeros((60, 60), np.complex64), "complex64"),
    ],
)
def test_picture_that_does_not_fit_the_parts_is_refused(picture, message):
    with pytest.raises(PictureError, match=message):
        Layering(parts_of(disc(20, 60)), 0.08, GIVEN, picture)


@pytest.mark.parametrize(
    ("heights_m", "message"),
    [([0.001], "2 parts and 1 heights"), ([0, np.nan], "part 2"), ([-0.001, 0], "part 1"), ([0, np.inf], "part 2")],
)
def test_wrong_heights_are_refused(heights_m, message):
    with pytest.raises(GeometryError, match=message):
        Layering(parts_of(disc(20, 60)), 0.08, GIVEN).relief(heights_m)


def test_wrong_width_is_refused():
    with pytest.raises(GeometryError, match="width_m"):
        Layering(parts_of(disc(20, 60)), 0, GIVEN)
