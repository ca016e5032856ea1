"""Simplified parts: if a case fails, fingers cannot read them, or a part is lost that could be read."""

import cv2
import numpy as np
import pytest

import drawn_parts
from colour_parts import by_colour
from tangible_core import load_method
from tangible_core.data import PartMap, SegmentMap
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


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("coffee", "drawn"),
        ("coffee", "colours"),
        pytest.param("motorcycle", "drawn", marks=pytest.mark.whole),
        pytest.param("motorcycle", "gradient", marks=pytest.mark.whole),
    ],
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


def test_simplify_passing_parts_are_unchanged():
    labels = np.zeros((300, 400), np.int32)
    labels[:, 201:] = 1
    found = simplify(PartMap(labels, (0, 1)), 0.028, CHOICE)
    assert np.array_equal(found.labels, labels)


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
    assert (np.unique(found.labels).tolist(), found.count) == ([0, 1], 3)
    assert found.labels[found.labels.shape[0] // 2, found.labels.shape[1] // 2] == 1


def test_simplify_picture_below_a_fingertip_notes_the_size_that_passes():
    labels = np.zeros((50, 50), np.int32)
    labels[:, 25:] = 1
    with collected() as notes:
        found = simplify(PartMap(labels, (0, 1)), 0.005, CHOICE)
    assert len(np.unique(found.labels)) == 1
    assert any("make the whole 6.7 mm wide" in note for note in notes)


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
