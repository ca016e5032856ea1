"""Steps between neighbours and differences of materials, pins, and cells that vote, with answers worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from tangible_core.data import PartMap, Relief
from tangible_core.materials.assignment import library
from tangible_legibility import apart
from tangible_legibility.cells import vote
from tangible_legibility.grid import on_grid
from tangible_legibility.neighbours import sample_relief, steps_between
from tangible_legibility.pins import PIN_PITCH_M, show_on_pins

PITCH_M = 0.00025


def steps(labels: np.ndarray, height_mm: np.ndarray):
    rows, columns = labels.shape
    relief = Relief(np.float32(height_mm / 1000 * np.ones(labels.shape)), (PITCH_M * columns, PITCH_M * rows))
    parts = PartMap(labels.astype(np.int32), tuple(range(int(labels.max()) + 1)))
    return steps_between(parts, PITCH_M, relief)


@pytest.mark.parametrize("turned", [False, True], ids=["columns", "rows"])
def test_step_is_the_median_along_the_border(turned: bool):
    labels = np.repeat([[0, 1]], 20, axis=1).repeat(30, 0)
    height_mm = labels * np.repeat([1, 2, 7], 10)[:, None]
    found = steps(labels.T, height_mm.T) if turned else steps(labels, height_mm)
    assert (found.low.tolist(), found.high.tolist()) == ([0], [1])
    assert found.step_m == pytest.approx([0.002])
    assert found.length_m == pytest.approx([30 * PITCH_M])


def test_step_goes_from_the_lower_number_on_both_sides_of_a_part():
    """1 mm up on the left and 3 mm down on the right: of values in order the lower one of two in the middle."""
    labels = np.repeat([[0, 1, 0]], 20, axis=1).repeat(30, 0)
    assert steps(labels, np.repeat([1, 2, 5], 20)[None]).step_m == pytest.approx([0.003])


def test_step_is_taken_at_a_millimetre_on_either_side():
    """Four cells: between their middles there are seven, of 0.1 mm each."""
    labels = np.repeat([[0, 1]], 20, axis=1).repeat(5, 0)
    assert steps(labels, 0.1 * np.arange(40)[None]).step_m == pytest.approx([0.0007])


def test_relief_is_sampled_at_the_middles_of_cells():
    relief = Relief(np.float32([[0, 1, 2, 3]]), (0.04, 0.01))
    assert sample_relief(relief, (1, 2)).height_m.tolist() == [[1, 3]]


def test_materials_are_apart_by_what_differs_most():
    stone = replace(library()["sand"], static_friction=2.0)
    assert apart(stone, stone) == 0
    for name, factor in (
        ("stiffness_n_per_m", 1.45),
        ("dynamic_friction", 1.2),
        ("roughness_m", 1.1),
        ("grain_m", 1.1),
    ):
        for times in (1, 3):
            other = replace(stone, **{name: getattr(stone, name) * factor**times})
            assert apart(stone, other) == pytest.approx(times)
            assert apart(other, stone) == pytest.approx(times)


def test_grain_of_smooth_materials_does_not_count():
    ice = library()["ice"]
    assert ice.texture == "smooth"
    assert apart(ice, replace(ice, grain_m=9 * max(ice.grain_m, 1e-3))) == 0


def test_pin_shows_the_part_of_most_of_its_cell():
    labels = np.zeros((8, 16), np.int32)
    labels[4:, :3], labels[:4, 4] = 1, 2
    shown = show_on_pins(PartMap(labels, (0, 1, 2)), PIN_PITCH_M / 4)
    assert shown.parts == ((0, 7, (0, 0)), (1, 1, (4, 0)), (2, 0, (0, 4)))


def test_border_is_kept_that_is_shown_within_a_pin():
    """A border a cell beside that of the pins, and a speck that no pin shows, of three sides."""
    labels = np.zeros((40, 40), np.int32)
    labels[:, 21:], labels[10, 5] = 1, 2
    assert show_on_pins(PartMap(labels, (0, 1, 2)), PIN_PITCH_M / 4).kept == pytest.approx(40 / 43)


def test_cells_of_a_long_picture_are_larger():
    parts = PartMap(np.zeros((400, 100), np.int32), (0,))
    assert on_grid(parts, 0.12).pitch_m == pytest.approx(0.0003)
    assert on_grid(parts, 0.12).parts.labels.shape == (1600, 400)


def test_vote_changes_removed_cells_alone():
    labels = np.zeros((9, 9), np.int32)
    labels[4, 4] = labels[0, 0] = 1
    removed = np.zeros((9, 9), bool)
    removed[0, 0] = True
    after = vote(labels, removed, ~removed, 1.0)
    assert (after[4, 4], after[0, 0], after.sum()) == (1, 0, 1)


@pytest.mark.parametrize("turns", range(4))
def test_vote_counts_in_the_corners_of_the_map_too(turns: int):
    """The nearest cell of the corner is of the one label, and the many around it of the other."""
    labels, removed = np.zeros((6, 6), np.int32), np.zeros((6, 6), np.bool_)
    labels[0, 1] = 1
    removed[:2, 0] = True
    wanted = np.rot90(labels.copy(), turns)
    labels[:2, 0] = 1
    removed = np.ascontiguousarray(np.rot90(removed, turns))
    np.testing.assert_array_equal(vote(np.ascontiguousarray(np.rot90(labels, turns)), removed, ~removed, 2.0), wanted)
