"""Parts made legible: that they pass, that this changes nothing twice, and what is said of what is lost."""

from time import process_time

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import drawn_parts
from colour_parts import by_colour
from tangible_core import load_method
from tangible_core.data import PartMap, SegmentMap
from tangible_core.errors import GeometryError
from tangible_core.legibility import SimplifyChoice, legibility, simplify
from tangible_core.parts import find_parts
from tangible_core.plugins.notes import collected

WIDTH_M = 0.16
CHOICE = SimplifyChoice()
RULES = ("gap", "part", "textures")


def failing(parts: PartMap, width_m: float, names=()) -> list[str]:
    found = legibility("swell", parts, width_m, names=names)
    return [each.check for each in found if each.check in RULES and each.verdict != "ok"]


def in_segments(parts: PartMap) -> np.ndarray:
    return np.array(parts.segments)[parts.labels]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "how"),
    [("coffee", "drawn"), ("motorcycle", "drawn"), ("coffee", "colours"), ("motorcycle", "gradient")],
)
def test_pictures_pass_when_they_are_simplified_and_twice_is_the_same_as_once(name, how):
    drawn = drawn_parts.drawn(name)
    names = drawn.names if how == "drawn" else ()
    if how == "gradient":
        parts = find_parts(load_method("texture", "gradient")(segments=20).segment(drawn.picture))
    else:
        parts = drawn.parts if how == "drawn" else by_colour(drawn.picture)
    assert failing(parts, WIDTH_M, names)
    begun_s = process_time()
    found = simplify(parts, WIDTH_M, CHOICE, names, drawn.picture)
    assert process_time() - begun_s < 20
    assert failing(found, WIDTH_M, names) == []
    assert found.count == parts.count
    again = simplify(found, WIDTH_M, CHOICE, names, cv2.resize(drawn.picture, found.labels.shape[::-1]))
    assert np.array_equal(again.labels, found.labels)
    assert again.segments == found.segments
    assert len(np.unique(found.labels)) > 3


@given(st.integers(0, 2**32 - 1), st.integers(2, 9), st.sampled_from([0.04, 0.06, 0.1]))
@settings(max_examples=10, deadline=None)
@pytest.mark.slow
def test_whatever_parts_there_are_pass_or_are_said_not_to(seed, count, width_m):
    rng = np.random.default_rng(seed)
    rows, columns = rng.integers(40, 160, 2)
    noise = rng.random((rows, columns)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), float(rng.uniform(0.5, 12)))
    ranks = smooth.argsort(axis=None).argsort().reshape(smooth.shape)
    parts = find_parts(SegmentMap((ranks * count // smooth.size).astype(np.int32)))
    names = ["", "house", *[""] * 3, "tree"][: int(rng.integers(0, 7))]
    with collected() as notes:
        found = simplify(parts, width_m, CHOICE, names)
    passes = failing(found, width_m, names) == []
    assert passes or any("fingers cannot read" in note for note in notes)
    again = simplify(found, width_m, CHOICE, names)
    assert not passes or (np.array_equal(again.labels, found.labels) and again.segments == found.segments)
    gone = [n for n, name in enumerate(names[: parts.count]) if name and not (found.labels == n).any()]
    assert all(any(f"part {number} ({names[number]})" in note for note in notes) for number in gone[:3])


def test_what_passes_stays_as_it_is():
    labels = np.zeros((300, 400), np.int32)
    labels[:, 201:] = 1
    found = simplify(PartMap(labels, (0, 1)), 0.028, CHOICE)
    assert np.array_equal(found.labels, labels)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["coffee", "astronaut"])
def test_a_picture_of_twice_the_pixels_has_the_same_verdicts_and_parts(name):
    drawn = drawn_parts.drawn(name)
    small = drawn.parts
    large = PartMap(small.labels.repeat(2, 0).repeat(2, 1), small.segments)
    verdicts = [legibility("swell", each, WIDTH_M, names=drawn.names) for each in (small, large)]
    assert [(each.check, each.of, each.verdict) for each in verdicts[0]] == [
        (each.check, each.of, each.verdict) for each in verdicts[1]
    ]
    pixel_m = WIDTH_M / small.labels.shape[1]
    assert [each.value for each in verdicts[0]] == pytest.approx([each.value for each in verdicts[1]], abs=pixel_m)
    found, finer = (simplify(each, WIDTH_M, CHOICE, drawn.names, drawn.picture) for each in (small, large))
    shape = finer.labels.shape[::-1]
    labels = cv2.resize(found.labels, shape, interpolation=cv2.INTER_NEAREST)
    kernel = np.ones((2 * shape[0] // small.labels.shape[1] + 1,) * 2, np.uint8)
    far = cv2.erode((labels != finer.labels).view(np.uint8), kernel)
    assert np.count_nonzero(far) == 0


def test_strips_of_3_1_mm_become_one_part_and_of_3_3_mm_stay():
    for width_px, stays in ((31, False), (33, True)):
        labels = np.repeat(np.arange(10), width_px)[None].repeat(400, 0).astype(np.int32) % 2
        parts = find_parts(SegmentMap(labels))
        choice = SimplifyChoice(part_m=0.0032)
        found = simplify(parts, labels.shape[1] * 1e-4, choice)
        assert (len(np.unique(found.labels)) == parts.count) == stays


def house(size: int, window: int, name: str = "") -> tuple[PartMap, list[str]]:
    """A square within a picture, and a small square within it, in tenths of a millimetre."""
    labels = np.zeros((600, 600), np.int32)
    at = 300 - size // 2
    labels[at : at + size, at : at + size] = 1
    at = 300 - window // 2
    labels[at : at + window, at : at + window] = 2
    return PartMap(labels, (0, 1, 2)), ["", "house", name]


def test_a_part_that_is_too_small_goes_to_what_is_around_it_and_numbers_stay():
    parts, names = house(400, 40)
    found = simplify(parts, 0.06, CHOICE, names)
    assert np.unique(found.labels).tolist() == [0, 1]
    assert found.count == 3
    assert found.labels[found.labels.shape[0] // 2, found.labels.shape[1] // 2] == 1


def test_a_named_part_that_is_too_small_is_told_with_its_size_and_the_cure():
    parts, names = house(400, 40, "window")
    with collected() as notes:
        simplify(parts, 0.06, CHOICE, names)
    (note,) = notes
    assert "part 2 (window), in which a disc of 4 mm fits" in note
    assert "make the whole 96 mm wide (`workspace.width_m`), or have fewer and larger parts" in note


def test_textures_that_are_alike_become_one_but_named_parts_stay():
    greys = np.repeat(np.linspace(0, 250, 8).astype(np.uint8), 100)
    labels = np.repeat(np.arange(8), 100)[None].repeat(200, 0).astype(np.int32)
    greys[labels[0] == 3] = greys[labels[0] == 2]
    picture = np.stack([np.broadcast_to(greys, labels.shape)] * 3, axis=2)
    parts = PartMap(labels, tuple(range(8)))
    found = simplify(parts, 0.16, SimplifyChoice(textures=7), (), picture)
    assert np.unique(found.labels).tolist() == [0, 1, 2, 4, 5, 6, 7]
    named = simplify(parts, 0.16, SimplifyChoice(textures=4), ("", "", "cup", "plate"), picture)
    assert {2, 3} <= set(np.unique(named.labels).tolist())
    assert len({named.segments[n] for n in np.unique(named.labels).tolist() if n not in (2, 3)}) == 4


def test_parts_of_one_texture_that_do_not_touch_keep_their_numbers_and_share_a_segment():
    labels = np.repeat(np.arange(3), 200)[None].repeat(200, 0).astype(np.int32)
    picture = np.array([10, 200, 20], np.uint8)[labels][..., None].repeat(3, 2)
    found = simplify(PartMap(labels, (4, 7, 5)), 0.09, SimplifyChoice(textures=2), (), picture)
    assert np.unique(found.labels).tolist() == [0, 1, 2]
    assert found.segments[0] == found.segments[2] != found.segments[1]


def test_a_part_that_is_opened_into_two_is_told_to_be_of_two_pieces():
    labels = np.zeros((400, 600), np.int32)
    labels[100:300, 50:250], labels[100:300, 350:550], labels[190:210, 250:350] = 1, 1, 1
    with collected() as notes:
        found = simplify(PartMap(labels, (0, 1)), 0.06, CHOICE, ("", "glasses"))
    assert find_parts(SegmentMap(found.labels)).count == 3
    assert notes == ["simplified, these parts are of several pieces: part 1 (glasses) of 2"]


def test_a_picture_that_is_smaller_than_a_fingertip_cannot_pass_and_it_is_said_which_size_would():
    labels = np.zeros((50, 50), np.int32)
    labels[:, 25:] = 1
    with collected() as notes:
        found = simplify(PartMap(labels, (0, 1)), 0.005, CHOICE)
    assert len(np.unique(found.labels)) == 1
    assert any("7 mm wide they would pass" in note for note in notes)


@pytest.mark.parametrize("shape", [(1, 1), (1, 300), (300, 1), (2, 2)])
def test_the_least_of_pictures_are_simplified(shape):
    parts = find_parts(SegmentMap(np.arange(shape[0] * shape[1], dtype=np.int32).reshape(shape)))
    assert simplify(parts, 0.16, CHOICE).count == parts.count


def test_ten_thousand_parts_do_not_take_long():
    tiles = np.arange(10_000, dtype=np.int32).reshape(100, 100)
    parts = find_parts(SegmentMap(tiles.repeat(4, 0).repeat(4, 1)))
    colour = np.random.default_rng(0).integers(0, 255, (25, 25, 3), np.uint8).repeat(16, 0).repeat(16, 1)
    begun_s = process_time()
    found = simplify(parts, WIDTH_M, CHOICE, (), colour)
    assert process_time() - begun_s < 20
    assert failing(found, WIDTH_M) == []


@pytest.mark.parametrize("width_m", [0.0, -1.0, float("nan"), float("inf")])
def test_a_width_is_positive(width_m):
    with pytest.raises(GeometryError, match="width_m"):
        simplify(PartMap(np.zeros((2, 2), np.int32), (0,)), width_m, CHOICE)
