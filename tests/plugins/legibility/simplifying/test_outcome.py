"""The outcome of a simplification: if a case fails, a lost part is not noted, or a number names another part."""

import re

import numpy as np
import pytest

from tangible_core.data import PartMap
from tangible_core.parts import SimplifyChoice
from tangible_core.plugins.notes import collected
from tangible_legibility.grid import Grid
from tangible_legibility.simplifying import large as merging
from tangible_legibility.simplifying.large import texture_kinds
from tangible_legibility.simplifying.simplify import Failures, _number_pieces, find_failures, note_outcome
from tangible_legibility.widths import measure

PITCH_M = 0.0002
CHOICE = SimplifyChoice(textures=3)


def part_map(labels: np.ndarray, *segments: int) -> PartMap:
    return PartMap(labels.astype(np.int32), segments or tuple(range(int(labels.max()) + 1)))


def noted(before: PartMap, after: PartMap, names: tuple[str, ...] = ()) -> list[str]:
    wide = measure(after.labels, PITCH_M, CHOICE.gap_m)
    with collected() as notes:
        note_outcome(before, Grid(after, PITCH_M), wide, PITCH_M * before.labels.shape[1], CHOICE, names)
    return notes


def test_outcome_names_what_vanished_what_is_in_pieces_and_what_would_pass():
    """60 mm wide: a square of 4 mm with a name and one without are gone, and a stripe of 2 mm is in two pieces."""
    labels = np.zeros((200, 300), np.int32)
    labels[20:40, 20:40], labels[60:80, 20:40] = 1, 2
    labels[:, 200:210] = 3
    after = np.where(labels == 3, 3, 0)
    after[100:120, 200:210] = 0
    vanished, pieces, failed = noted(
        part_map(labels), PartMap(after.astype(np.int32), (0, 1, 2, 3)), ("", "moon", "", "mast")
    )
    assert vanished == (
        "merged into their neighbours, as too small or too narrow for a finger: part 2 (moon), in which a disc of 4 mm "
        "fits; a disc of 6.4 mm must fit, and 3.2 mm are needed everywhere: make the whole 96 mm wide "
        "(`workspace.width_m`), or have fewer and larger parts"
    )
    assert pieces == "simplified parts in several pieces: part 4 (mast) in 2"
    found = re.fullmatch(
        r"fingers cannot read the simplified parts \(2 too small and 2 places too narrow\); make the whole ([\d.]+) mm "
        "wide, or have fewer and larger parts",
        failed,
    )
    assert found and float(found[1]) == round(60 * 1.1**13)  # 1.1^12 is 3.14, and 3.2 is needed
    assert find_failures(part_map(labels), measure(labels, PITCH_M, CHOICE.gap_m), CHOICE, ("", "a")) == Failures(
        3, 1, 0
    )


def test_part_that_vanished_for_a_narrow_place_is_not_called_too_small():
    """A square of 20 mm with a tail of 2 mm."""
    labels = np.zeros((200, 300), np.int32)
    labels[50:150, 50:150] = labels[95:105, 150:250] = 1
    gone, *_ = noted(part_map(labels), part_map(np.zeros((200, 300))), ("", "kite"))
    assert ": part 2 (kite), which is too narrow in places; a disc of 6.4 mm must fit" in gone


def test_too_many_textures_are_no_matter_of_size():
    labels = np.repeat(np.arange(5), 80)[None].repeat(100, 0)
    (failed,) = noted(part_map(labels), part_map(labels))
    assert failed == ("fingers cannot read the simplified parts (2 textures too many); have fewer and larger parts")
    assert noted(part_map(labels), part_map(labels), ("", "a", "b")) == []
    assert noted(part_map(labels, 0, 1, 2, 1, 0), part_map(labels, 0, 1, 2, 1, 0)) == []


def test_a_piece_has_the_number_of_the_part_of_its_kind_that_covers_most_of_it():
    """Parts 0 and 2 are of one kind; of its pieces one covers more of 2, one more of 0, and one lies in part 1."""
    before = np.zeros((6, 20), np.int32)
    before[:, 5:12], before[:, 12:18], before[:, 18:] = 1, 2, 3
    kinds = np.array([0, 1, 0, 2], np.int32)
    labels = np.ones((6, 20), np.int32)
    labels[:, 0:3], labels[:, 11:20], labels[2:4, 7:9] = 0, 0, 0
    found = _number_pieces(part_map(before, 10, 11, 12, 13), labels, kinds)
    expected = np.ones((6, 20), np.int32)
    expected[:, 0:3], expected[:, 11:20] = 0, 2
    expected[2:4, 7:9] = 2  # the largest part of the kind
    assert np.array_equal(found.labels, expected)
    assert found.segments == (12, 11, 12, 13)


def greys(labels: np.ndarray, *values: int) -> np.ndarray:
    return np.array(values, np.uint8)[labels][..., None].repeat(3, 2)


def test_textures_that_add_least_to_the_spread_become_one():
    """By Ward: two small parts that differ more join before two large ones that differ less; a name keeps apart."""
    labels = np.repeat(np.arange(5), [40, 40, 2, 2, 16])[None].repeat(20, 0).astype(np.int32)
    parts, picture = part_map(labels, 7, 5, 3, 1, 0), greys(labels, 100, 110, 180, 200, 250)

    def kinds(textures: int, names: tuple[str, ...] = (), picture: np.ndarray | None = picture) -> list[int]:
        return texture_kinds(parts, names, textures, picture).tolist()

    assert (kinds(5), kinds(4), kinds(3)) == ([0, 1, 2, 3, 4], [0, 1, 2, 2, 3], [0, 0, 1, 1, 2])
    assert kinds(2) == [0, 0, 1, 1, 1]
    assert kinds(1) == [0] * 5
    assert kinds(3, ("", "", "", "a")) == [0, 0, 1, 2, 3]
    assert kinds(3, ("a", "b", "c", "d", "e")) == [0, 1, 2, 3, 4]
    assert kinds(4, (), None) == [0, 1, 2, 2, 3]  # without a picture, the smallest
    assert kinds(3, (), None) == [0, 1, 2, 2, 2]
    same = part_map(labels, 7, 5, 7, 1, 0)
    assert texture_kinds(same, ("", "", "a"), 9, None).tolist() == [0, 1, 2, 3, 4]
    assert texture_kinds(same, (), 9, None).tolist() == [0, 1, 0, 2, 3]


def test_of_very_many_textures_the_smallest_go_to_the_most_alike(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(merging, "MAX_COMPARED", 3)
    labels = np.repeat(np.arange(5), [40, 3, 30, 2, 20])[None].repeat(20, 0).astype(np.int32)
    found = texture_kinds(part_map(labels), (), 4, greys(labels, 10, 240, 100, 20, 250))
    assert found.tolist() == [0, 2, 1, 0, 2]
