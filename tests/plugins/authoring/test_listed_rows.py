"""Rows of the list of parts, colours and moves of their pictures, and the schema as it is printed."""

import cv2
import numpy as np

from tangible_authoring.listed_parts import MAX_CELLS, ListedPart, list_rows
from tangible_authoring.renumbering import Moved, moves
from tangible_core.data import PartMap
from tangible_core.parts import PartChoice, PartHeights
from tangible_core.scene.formats.pictures import DARKEST, LIGHTEST, MAX_CHROMA, STEPS, distinct_colours
from tangible_report.numbered_parts import Before


def test_rows_have_place_share_height_and_material_of_each_part():
    labels = np.zeros((100, 2 * MAX_CELLS + 100), np.int32)
    labels[:, 900:], labels[99, 1], labels[40:60, 500:600] = 1, 2, 3
    heights = PartHeights((0.001, 0.002, 0.0, 0.003), ("a", "b", "c", "d"))
    choices = {1: PartChoice(name=" sea ", material="wood"), 3: PartChoice(name="sun")}
    rows = list_rows(PartMap(labels, (0, 1, 2, 3)), heights, choices)
    cells = labels.size
    assert rows == (
        ListedPart(0, "", "", (90_000 - 2001) / cells, 0.001, "a", ""),
        ListedPart(1, "sea", "on the right", 22_400 / cells, 0.002, "b", "wood"),
        ListedPart(2, "", "at the lower left", 1 / cells, 0.0, "c", ""),
        ListedPart(3, "sun", "in the middle", 2000 / cells, 0.003, "d", ""),
    )
    flat = list_rows(PartMap(labels, (0, 1, 2, 3)), None, {})
    assert {(each.height_m, each.why) for each in flat} == {(None, "")}


def test_each_colour_is_the_farthest_of_all_from_those_before_it():
    """By a search through all colours of the cube that are neither too dark, nor too light, nor glaring."""
    steps = np.rint(np.linspace(0, 255, STEPS))
    cube = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), -1).reshape(-1, 3).astype(np.uint8)
    lab = cv2.cvtColor(cube[None].astype(np.float32) / 255, cv2.COLOR_RGB2LAB)[0]
    chroma = np.hypot(lab[:, 1], lab[:, 2])
    cube, lab = (
        each[(lab[:, 0] >= DARKEST) & (lab[:, 0] <= LIGHTEST) & (chroma <= MAX_CHROMA)] for each in (cube, lab)
    )
    chosen = distinct_colours(30)
    at = [int(np.flatnonzero((cube == each).all(axis=1))[0]) for each in chosen]
    assert np.hypot(lab[at[0], 1], lab[at[0], 2]) == np.hypot(lab[:, 1], lab[:, 2]).max()
    for number in range(1, 30):
        nearest = np.linalg.norm(lab[:, None] - lab[at[:number]], axis=2).min(axis=1)
        assert nearest[at[number]] > nearest.max() - 1e-3


def test_moves_are_those_of_parts_that_the_file_names():
    """Three parts were 0, 1, 2, 3: the second was cut in two, the third is gone."""
    before = [Before(0, 0), Before(1, 1), Before(None, 1), Before(3, 3)]
    written = {
        0: "wall",
        1: {"name": "head"},
        2: {"height_m": "1 mm"},
        3: {"name": "foot", "material": "wood"},
        9: "old",
    }
    assert moves(written, before) == [Moved(2, None, ""), Moved(9, None, "old")]
    later = [Before(0, 0), Before(None, 1), Before(1, 1), Before(3, 3)]
    assert moves(written, later) == [Moved(1, 2, "head"), Moved(2, None, ""), Moved(9, None, "old")]
    assert moves(written, []) == []
