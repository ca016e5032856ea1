"""Steps between neighbours and differences of materials, pins, and cells that vote, with answers worked out by hand."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt, gaussian_filter

from tangible_core.data import PartMap, Relief
from tangible_core.materials.assignment import library
from tangible_legibility import apart
from tangible_legibility.cells import FEW, vote
from tangible_legibility.grid import on_grid
from tangible_legibility.neighbours import sample_relief, steps_between
from tangible_legibility.pins import PIN_PITCH_M, show_on_pins
from tangible_legibility.words.languages import TABLES, Words, one_line
from tangible_legibility.words.places import place_of_counts
from tangible_legibility.words.texts import describe_place

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


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("sigma", [0.8, 1.5, 3.0])
def test_vote_is_that_of_gaussians_over_the_whole_map(seed: int, sigma: float):
    """Where no voter is near, the nearest decides; near ties, and cells as far from two labels, are left open."""
    rng = np.random.default_rng(seed)
    labels = np.ascontiguousarray(rng.integers(0, 5, (9, 12)).repeat(4, 0).repeat(4, 1).astype(np.int32))
    removed = rng.random(labels.shape) < 0.3
    removed[10:30, 6:40] = True
    voters = ~removed & (rng.random(labels.shape) < 0.7)
    found = vote(labels, removed, voters, sigma)
    assert np.array_equal(found[~removed], labels[~removed])
    votes = np.stack(
        [
            gaussian_filter((voters & (labels == each)).astype(float), sigma, mode="nearest", truncate=6)
            for each in range(5)
        ]
    )
    second, first = np.sort(votes, axis=0)[-2:]
    clear = removed & (first > 2 * FEW) & (first > second + 1e-3)
    assert clear.sum() > 100
    assert np.array_equal(found[clear], votes.argmax(axis=0)[clear])
    far = np.stack([distance_transform_edt(removed | (labels != each)) for each in range(5)])
    alone = removed & (first < FEW / 2) & (np.sort(far, axis=0)[1] > 1.05 * far.min(axis=0))
    assert alone.any() or sigma > 1
    assert np.array_equal(found[alone], far.argmin(axis=0)[alone])


@pytest.mark.parametrize(("rows", "columns", "cell"), [(17, 23, 3.0), (40, 31, 4.2), (5, 60, 2.5), (3, 3, 8.0)])
def test_pins_are_counted_cell_by_cell(rows: int, columns: int, cell: float):
    """Each cell belongs to the pin of its share of the display, which shows the part of most of its cells."""
    rng = np.random.default_rng(rows)
    labels = rng.integers(0, 4, (-(-rows // 5), -(-columns // 5))).repeat(5, 0).repeat(5, 1)[:rows, :columns]
    labels[rng.random(labels.shape) < 0.1] = 4
    shown = show_on_pins(PartMap(labels.astype(np.int32), tuple(range(5))), PIN_PITCH_M / cell)
    down, right = max(1, round(rows / cell)), max(1, round(columns / cell))
    cells: dict[tuple[int, int], list[int]] = {}
    for y, x in np.ndindex(rows, columns):
        cells.setdefault((y * down // rows, x * right // columns), []).append(int(labels[y, x]))
    certain = {pin: part for pin, part in ((pin, most(some)) for pin, some in cells.items()) if part is not None}
    for number, pins, place in shown.parts:
        assert place == tuple(np.argwhere(labels == number)[0].tolist())
        assert 0 <= pins - list(certain.values()).count(number) <= len(cells) - len(certain)
    assert sum(pins for _, pins, _ in shown.parts) == down * right
    assert [number for number, _, _ in shown.parts] == np.unique(labels).tolist()


def most(some: list[int]) -> int | None:
    """Return what comes most often; None for a tie."""
    counts = sorted({(some.count(each), each) for each in some})
    return counts[-1][1] if len(counts) < 2 or counts[-1][0] > counts[-2][0] else None


def test_pins_larger_than_the_map_show_one_part_and_no_border():
    labels = np.zeros((6, 6), np.int32)
    labels[:, 4:] = 1
    found = show_on_pins(PartMap(labels, (0, 1)), PIN_PITCH_M / 20)
    assert (found.parts, found.kept) == (((0, 1, (0, 0)), (1, 0, (0, 4))), 0.0)
    assert show_on_pins(PartMap(np.zeros((6, 6), np.int32), (0,)), PIN_PITCH_M / 20).kept == 1.0


@pytest.mark.parametrize(
    ("shape", "width_m", "worked", "pitch_m", "columns"),
    [
        ((10, 10), 0.01, False, 0.00025, 40),  # 1 mm is divided in four
        ((10, 10), 0.0025, False, 0.00025, 10),
        ((10, 10), 0.0026, False, 0.00013, 20),
        ((10, 400), 0.04, False, 0.0001, 400),
        ((10, 400), 0.04, True, 0.0002, 200),
        ((10, 400), 0.02, False, 0.0001, 200),  # finer than a sixteenth of a millimetre
        ((10, 400), 0.025, False, 0.0000625, 400),
        ((10, 1000), 0.64, False, 0.00032, 2000),  # 1280 of the largest cells at most
        ((1000, 10), 0.0064, False, 0.00032, 20),
        ((10, 5000), 0.64, False, 0.000256, 2500),  # 2560 of the smallest
        ((10, 5000), 0.64, True, 0.000256, 2500),
        ((10, 5000), 0.32, True, 0.000128, 2500),
    ],
)
def test_cells_are_within_their_bounds(
    shape: tuple[int, int], width_m: float, worked: bool, pitch_m: float, columns: int
):
    grid = on_grid(PartMap(np.zeros(shape, np.int32), (0,)), width_m, worked=worked)
    assert grid.pitch_m == pytest.approx(pitch_m)
    assert grid.parts.labels.shape == (max(1, round(shape[0] * columns / shape[1])), columns)


@pytest.mark.parametrize(
    ("down", "across", "place"),
    [
        ([6, 2, 2], [1, 3, 6], "0 2"),  # from 60 % on in a third
        ([59, 21, 20], [20, 59, 21], "- -"),
        ([2, 6, 2], [1, 1, 8], "1 2"),
        ([45, 0, 35, 0, 11, 9], [20, 0, 0, 40, 0, 40], "0 2"),  # from 80 % on in a half
        ([40, 0, 39, 0, 1, 20], [20, 1, 0, 39, 0, 40], "- -"),
        ([40, 40, 0, 20, 0], [1, 0, 17, 41, 41], "0 2"),  # the middle row is in neither half
        ([1, 1], [3], "- -"),
    ],
)
def test_place_is_the_third_or_half_with_most_of_a_part(down: list[int], across: list[int], place: str):
    assert place_of_counts(np.array(down), np.array(across)) == place


def test_places_of_points_are_those_of_thirds():
    names = [[describe_place(x, y) for x in (0.0, 0.32, 0.34, 0.65, 0.67, 1.0)] for y in (0.0, 0.5, 1.0)]
    assert [list(dict.fromkeys(each)) for each in names] == [
        ["at the upper left", "at the top in the middle", "at the upper right"],
        ["on the left, halfway down", "in the middle", "on the right, halfway down"],
        ["at the lower left", "at the bottom in the middle", "at the lower right"],
    ]
    assert [[row.count(each) for each in dict.fromkeys(row)] for row in names] == [[2, 2, 2]] * 3


def test_numbers_lists_and_materials_are_in_the_language():
    english, german, french = (Words(each) for each in ("en", "de", "fr"))
    values = (0.254, 2.0, 99.4, 99.6, 100.4, 1234.5)
    assert [english.number(each) for each in values] == ["0.25", "2", "99", "100", "100", "1234"]
    assert [german.number(each) for each in values] == ["0,25", "2", "99", "100", "100", "1234"]
    assert [german.join(list(each)) for each in ("a", "ab", "abc")] == ["a", "a und b", "a, b und c"]
    assert (german.material("wood"), german.material("my stuff")) == ("Holz", "my stuff")
    assert french.material_after_like("wood") != french.material("wood") == "bois"
    assert french.material_after_like("my stuff", str.upper) == "MY STUFF"
    marked = {key: text for key, text in TABLES["fr"].words.items() if re.search(" [:;%]", text) and "{" not in text}
    assert marked
    assert all(french(key) == re.sub(" (?=[:;%])", "\u00a0", text) for key, text in marked.items())
    assert one_line(" a\tb\u00a0c\x00\ud800 \n") == "a b c"
