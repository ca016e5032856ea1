"""Simplified parts: they pass, a second simplification changes nothing, and lost parts are noted."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import drawn_parts
from colour_parts import by_colour
from tangible_core import load_method
from tangible_core.data import PartMap, SegmentMap
from tangible_core.data.part_words import name_part
from tangible_core.errors import GeometryError
from tangible_core.parts import SimplifyChoice, find_parts
from tangible_core.plugins.notes import collected
from tangible_legibility import legibility, simplify
from tangible_legibility.simplifying import opening

WIDTH_M = 0.16
CHOICE = SimplifyChoice()
RULES = ("gap", "part", "textures")


def failing(parts: PartMap, width_m: float, names=()) -> list[str]:
    found = legibility("swell", parts, width_m, names=names)
    return [each.check for each in found if each.check in RULES and each.verdict != "ok"]


def segments_of_cells(parts: PartMap) -> np.ndarray:
    return np.array(parts.segments)[parts.labels]


@pytest.mark.parametrize(
    ("name", "how"),
    [("coffee", "drawn"), ("motorcycle", "drawn"), ("coffee", "colours"), ("motorcycle", "gradient")],
)
def test_simplify_picture_passes_and_twice_is_the_same_as_once(name, how):
    drawn = drawn_parts.drawn(name)
    names = drawn.names if how == "drawn" else ()
    if how == "gradient":
        parts = find_parts(load_method("texture", "gradient")(segments=20).segment(drawn.picture))
    else:
        parts = drawn.parts if how == "drawn" else by_colour(drawn.picture)
    assert failing(parts, WIDTH_M, names)
    found = simplify(parts, WIDTH_M, CHOICE, names, drawn.picture)
    assert failing(found, WIDTH_M, names) == []
    assert found.count == parts.count
    again = simplify(found, WIDTH_M, CHOICE, names, cv2.resize(drawn.picture, found.labels.shape[::-1]))
    assert np.array_equal(again.labels, found.labels)
    assert again.segments == found.segments
    assert len(np.unique(found.labels)) > 3


@given(st.integers(0, 2**32 - 1), st.integers(2, 9), st.sampled_from([0.04, 0.06, 0.1]))
@settings(max_examples=10, deadline=None)
def test_simplify_random_parts_pass_or_are_reported(seed, count, width_m):
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
    assert all(any(name_part(number, names[number]) in note for note in notes) for number in gone[:3])


def test_simplify_passing_parts_are_unchanged():
    labels = np.zeros((300, 400), np.int32)
    labels[:, 201:] = 1
    found = simplify(PartMap(labels, (0, 1)), 0.028, CHOICE)
    assert np.array_equal(found.labels, labels)


@pytest.mark.parametrize("name", ["coffee", "astronaut"])
def test_simplify_twice_the_pixels_gives_the_same_parts(name):
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


def test_simplify_strips_below_the_gap_become_one_part():
    for width_px, stays in ((31, False), (33, True)):
        labels = np.repeat(np.arange(10), width_px)[None].repeat(400, 0).astype(np.int32) % 2
        parts = find_parts(SegmentMap(labels))
        choice = SimplifyChoice(part_m=0.0032)
        found = simplify(parts, labels.shape[1] * 1e-4, choice)
        assert (len(np.unique(found.labels)) == parts.count) == stays


def house(size: int, window: int, name: str = "") -> tuple[PartMap, list[str]]:
    """Return a square within a picture, and a small square within it, in tenths of a millimetre."""
    labels = np.zeros((600, 600), np.int32)
    at = 300 - size // 2
    labels[at : at + size, at : at + size] = 1
    at = 300 - window // 2
    labels[at : at + window, at : at + window] = 2
    return PartMap(labels, (0, 1, 2)), ["", "house", name]


def test_simplify_small_part_goes_to_its_neighbour():
    parts, names = house(400, 40)
    found = simplify(parts, 0.06, CHOICE, names)
    assert np.unique(found.labels).tolist() == [0, 1]
    assert found.count == 3
    assert found.labels[found.labels.shape[0] // 2, found.labels.shape[1] // 2] == 1


def test_simplify_works_on_cells_of_an_eighth_of_a_millimetre():
    """Pixels of a sixteenth: what fails is changed on every second one, and what passes keeps them all."""
    parts, _ = house(400, 60)
    labels = parts.labels[:512, :512]
    assert simplify(PartMap(labels, (0, 1, 2)), 0.032, CHOICE).labels.shape == (256, 256)
    halves = (np.indices((512, 512))[1] >= 256).astype(np.int32)
    assert simplify(PartMap(halves, (0, 1)), 0.032, CHOICE).labels.shape == (512, 512)


def test_simplify_small_named_part_is_noted_with_a_cure():
    parts, names = house(400, 40, "window")
    with collected() as notes:
        simplify(parts, 0.06, CHOICE, names)
    (note,) = notes
    assert "part 3 (window), in which a disc of 4 mm fits" in note
    assert "make the whole 96 mm wide (`workspace.width_m`), or have fewer and larger parts" in note


def test_simplify_similar_textures_become_one_except_named_parts():
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


def test_simplify_separate_parts_of_one_texture_share_a_segment():
    labels = np.repeat(np.arange(3), 200)[None].repeat(200, 0).astype(np.int32)
    picture = np.array([10, 200, 20], np.uint8)[labels][..., None].repeat(3, 2)
    found = simplify(PartMap(labels, (4, 7, 5)), 0.09, SimplifyChoice(textures=2), (), picture)
    assert np.unique(found.labels).tolist() == [0, 1, 2]
    assert found.segments[0] == found.segments[2] != found.segments[1]


def test_simplify_part_split_in_two_is_noted():
    labels = np.zeros((400, 600), np.int32)
    labels[100:300, 50:250], labels[100:300, 350:550], labels[190:210, 250:350] = 1, 1, 1
    with collected() as notes:
        found = simplify(PartMap(labels, (0, 1)), 0.06, CHOICE, ("", "glasses"))
    assert find_parts(SegmentMap(found.labels)).count == 3
    assert notes == ["simplified parts in several pieces: part 2 (glasses) in 2"]


def test_simplify_picture_below_a_fingertip_notes_the_size_that_passes():
    labels = np.zeros((50, 50), np.int32)
    labels[:, 25:] = 1
    with collected() as notes:
        found = simplify(PartMap(labels, (0, 1)), 0.005, CHOICE)
    assert len(np.unique(found.labels)) == 1
    assert any("make the whole 6.7 mm wide" in note for note in notes)


@pytest.mark.parametrize("shape", [(1, 1), (1, 300), (300, 1), (2, 2)])
def test_simplify_smallest_pictures_are_accepted(shape):
    parts = find_parts(SegmentMap(np.arange(shape[0] * shape[1], dtype=np.int32).reshape(shape)))
    assert simplify(parts, 0.16, CHOICE).count == parts.count


def test_simplify_ten_thousand_parts_pass():
    tiles = np.arange(10_000, dtype=np.int32).reshape(100, 100)
    parts = find_parts(SegmentMap(tiles.repeat(4, 0).repeat(4, 1)))
    colour = np.random.default_rng(0).integers(0, 255, (25, 25, 3), np.uint8).repeat(16, 0).repeat(16, 1)
    found = simplify(parts, WIDTH_M, CHOICE, (), colour)
    assert failing(found, WIDTH_M) == []


@pytest.mark.parametrize(
    ("box", "window"),
    [
        (np.s_[4:6, 5:7], np.s_[2:8, 3:9]),
        (np.s_[0:1, 1:3], np.s_[0:3, 0:5]),
        (np.s_[8:10, 10:11], np.s_[6:10, 8:12]),
    ],
)
def test_window_around_a_change_ends_with_the_map(box, window):
    assert opening._grow(box, 2, (10, 12)) == window


def test_opened_parts_are_measured_exactly_at_the_end():
    """A disc that passes: its quick width is off by a hundredth, and the exact one is not."""
    y, x = np.indices((240, 240)) - 119.5
    labels = (np.hypot(x, y) < 52.3).astype(np.int32)
    opened = opening.Opening(SimplifyChoice(), np.zeros(2, np.bool_), 0.0001, None)
    same, wide = opened.run(labels)
    exact, quick = (opening.measure(labels, 0.0001, 0.0032, quick=each).disc_m for each in (False, True))
    assert np.array_equal(same, labels)
    assert not np.array_equal(exact, quick)
    assert np.array_equal(wide.disc_m, exact)


def test_crumbs_go_to_the_nearest_cell_but_for_those_at_the_rim():
    """A window's rim may cut a piece. A disc of 4 cells has an area of 12.6: 13 cells are no crumb."""
    labels = np.zeros((30, 40), np.int32)
    labels[5:8, 5:9] = 1  # 12 cells
    labels[15:18, 5:9], labels[18, 5] = 2, 2  # 13
    labels[0, 20], labels[10, 39], labels[29, 20], labels[10, 0] = 3, 4, 5, 6
    labels[20:24, 30:33], labels[24, 33] = 7, 8  # 12 and one at its corner
    settled = opening.Opening(SimplifyChoice(part_m=0.004), np.zeros(9, np.bool_), 0.001, None)._remove_crumbs(labels)
    expected = labels.copy()
    expected[np.isin(labels, (1, 7, 8))] = 0
    assert np.array_equal(settled, expected)


@pytest.mark.parametrize("width_m", [0.0, -1.0, float("nan"), float("inf")])
def test_simplify_width_not_positive_is_refused(width_m):
    with pytest.raises(GeometryError, match="width_m"):
        simplify(PartMap(np.zeros((2, 2), np.int32), (0,)), width_m, CHOICE)
