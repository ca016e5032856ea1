"""Measures of neighbours, pins and cells: if a case fails, a verdict is reached by a false step, width or material."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt, gaussian_filter

from tangible_core.data import PartMap, Relief
from tangible_core.materials.assignment import library
from tangible_legibility import apart
from tangible_legibility.cells import FEW, vote
from tangible_legibility.grid import on_grid
from tangible_legibility.neighbours import PIN_PITCH_M, sample_relief, show_on_pins, steps_between
from tangible_legibility.words.places import place_of_counts

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


def test_relief_is_sampled_at_the_middles_of_cells():
    relief = Relief(np.float32([[0, 1, 2, 3]]), (0.04, 0.01))
    assert sample_relief(relief, (1, 2)).height_m.tolist() == [[1, 3]]


@pytest.mark.parametrize("turns", range(4))
def test_vote_counts_in_the_corners_of_the_map_too(turns: int):
    labels, removed = np.zeros((6, 6), np.int32), np.zeros((6, 6), np.bool_)
    labels[0, 1] = 1
    removed[:2, 0] = True
    wanted = np.rot90(labels.copy(), turns)
    labels[:2, 0] = 1
    removed = np.ascontiguousarray(np.rot90(removed, turns))
    np.testing.assert_array_equal(vote(np.ascontiguousarray(np.rot90(labels, turns)), removed, ~removed, 2.0), wanted)


@pytest.mark.parametrize(("seed", "sigma"), [(0, 0.8), (1, 1.5), (2, 3.0)])
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


@pytest.mark.parametrize(("rows", "columns", "cell"), [(40, 31, 4.2), (5, 60, 2.5), (3, 3, 8.0)])
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


@pytest.mark.parametrize(
    ("shape", "width_m", "worked", "pitch_m", "columns"),
    [
        ((10, 10), 0.01, False, 0.00025, 40),  # 1 mm is divided in four
        ((10, 10), 0.0026, False, 0.00013, 20),
        ((10, 400), 0.04, False, 0.0001, 400),
        ((10, 400), 0.04, True, 0.0002, 200),
        ((10, 400), 0.02, False, 0.0001, 200),  # finer than a sixteenth of a millimetre
        ((10, 400), 0.025, False, 0.0000625, 400),
        ((10, 1000), 0.64, False, 0.00032, 2000),  # 1280 of the largest cells at most
        ((10, 5000), 0.64, False, 0.000256, 2500),  # 2560 of the smallest
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
        ([2, 6, 2], [1, 1, 8], "1 2"),
        ([45, 0, 35, 0, 11, 9], [20, 0, 0, 40, 0, 40], "0 2"),  # from 80 % on in a half
        ([40, 0, 39, 0, 1, 20], [20, 1, 0, 39, 0, 40], "- -"),
        ([40, 40, 0, 20, 0], [1, 0, 17, 41, 41], "0 2"),  # the middle row is in neither half
    ],
)
def test_place_is_the_third_or_half_with_most_of_a_part(down: list[int], across: list[int], place: str):
    assert place_of_counts(np.array(down), np.array(across)) == place


def test_step_is_taken_at_a_millimetre_on_either_side():
    """Four cells: between their middles there are seven, of 0.1 mm each."""
    labels = np.repeat([[0, 1]], 20, axis=1).repeat(5, 0)
    assert steps(labels, 0.1 * np.arange(40)[None]).step_m == pytest.approx([0.0007])


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
