"""Cells, cues and joining of the tree of regions, against plain formulas: else people's borders are missed."""

from itertools import combinations
from math import log, sqrt

import numpy as np
import pytest

from tangible_texture.tree.cues import (
    CELLS,
    EMPTY,
    LEVELS,
    border_tensors,
    opponent_colours,
    reduce_to_cells,
    shares,
    tensors,
    weighted_strength,
)
from tangible_texture.tree.joining import TERMS, join_regions
from tangible_texture.tree.regions import Regions, measure_regions


def paint(shape: tuple[int, int] = (20, 30), channels: int = 3, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((*shape, channels)).astype(np.float32)


@pytest.mark.parametrize(("shape", "cells"), [((1, 1), (1, 1)), ((200, 200), (200, 200)), ((600, 300), (283, 141))])
def test_large_picture_is_reduced_to_at_most_the_cells_in_its_proportions(
    shape: tuple[int, int], cells: tuple[int, int]
):
    found = reduce_to_cells(paint(shape)).shape
    assert found == (*cells, 3)
    assert found[0] * found[1] <= CELLS * 1.01


def test_cell_is_the_mean_of_its_pixels():
    picture = paint((800, 800), 1)
    cells = reduce_to_cells(picture)
    assert cells.shape == (200, 200, 1)
    assert cells[..., 0] == pytest.approx(picture.reshape(200, 4, 200, 4).mean(axis=(1, 3)), abs=1e-5)


def test_opponent_colours_are_exact_whatever_single_values_are():
    picture = np.array([[[0, 0, 0], [1, 1, 1]], [[1, 0, 0], [0, 0, 1]]], np.float32)
    colours = opponent_colours(picture)
    assert colours is not None
    assert (
        pytest.approx(np.array([[0, 0, 0], [1, 0, 0], [0.299, 1, 0.5], [0.114, 0, -1]]), abs=1e-6)
        == colours.reshape(3, 4).T
    )
    picture = paint((100, 100), 1)
    torn = picture.copy()
    torn[3, 4] = 50
    one, other = opponent_colours(picture), opponent_colours(torn)
    assert one is not None
    assert other is not None
    assert np.abs(np.delete(one - other, 3, axis=1)).max() < 0.01


def test_shares_divide_values_between_bins_and_tell_roughness():
    colours = np.zeros((3, 1, 3), np.float32)
    colours[0] = [[0, 0.25 / 11, 1]]
    found = shares(colours)["brightness"][:, 0]
    assert found[:2, 1].tolist() == pytest.approx([0.75, 0.25])
    assert (found[0, 0], found[-1, 2], found[2:, 1].max()) == (1, 1, 0)
    colours = np.full((3, 40, 80), 0.5, np.float32)
    colours[0, :, 40:] += np.random.default_rng(0).normal(0, 0.1, (40, 40))
    rough = shares(colours)["roughness"]
    mean = (np.arange(len(rough))[:, None, None] * rough).sum(axis=0)
    assert mean[:, :30].max() < 1e-6
    assert mean[:, 46:].min() > 2


@pytest.mark.parametrize(
    ("across", "down", "way"),
    [(1, 0, 0), (0, 1, 1), (1, 1, 2), (1, -1, 3)],
    ids=["across", "down", "rising", "falling"],
)
def test_slope_in_one_direction_has_that_share_alone(across: int, down: int, way: int):
    rows, columns = np.indices((12, 12), np.float32)
    colours = np.zeros((3, 12, 12), np.float32)
    colours[0] = (across * columns + down * rows) / 10
    inner = shares(colours)["direction"][:, 2:-2, 2:-2]
    assert inner[way].min() > 0.8
    assert np.delete(inner, [way, 4], axis=0).max() < 1e-6


def test_tensors_are_those_of_ramps_and_of_steps_at_every_width():
    rows, columns = np.indices((30, 40), np.float32)
    found = tensors(0.03 * columns - 0.01 * rows, {})
    assert found.shape == (1, 3, 30, 40)
    assert (
        pytest.approx(np.array([[9e-4, -3e-4, 1e-4]] * 22 * 32), rel=1e-3) == found[0, :, 4:-4, 4:-4].reshape(3, -1).T
    )
    share = np.zeros((2, 48, 64), np.float32)
    share[0, :, :32], share[1, :, 32:] = 1, 1
    found = tensors(np.zeros((48, 64), np.float32), {"one": share, "none": np.ones((1, 48, 64), np.float32)})
    assert len(found) == 1 + 2 * LEVELS
    assert not found[0].any()
    assert not found[1 + LEVELS :].any()
    for level in range(LEVELS):
        across, mixed, down = found[1 + level]
        assert across[24, 31:33].min() > 0.5 * across.max()
        assert across[24, 31:33].max() > 50 * across[24, 0]
        assert np.abs(mixed).max() < 1e-6
        assert down.max() < 1e-6


def test_strength_is_that_of_square_roots_in_every_direction():
    share = np.zeros((1, 3, 200), np.float32)
    share[0] = np.linspace(0.2, 0.4, 200)
    found = tensors(np.zeros((3, 200), np.float32), {"one": share})[1, 0, 1, 20:-20]
    slope = 0.2 / 199
    assert found == pytest.approx(slope**2 / (4 * (share[0, 1, 20:-20] + EMPTY)), rel=1e-3)
    angles = np.linspace(0, np.pi, 7)
    steep, flat = 0.09, 0.01
    cosine, sine = np.cos(angles), np.sin(angles)
    tensor = np.array(
        [
            steep**2 * cosine**2 + flat**2 * sine**2,
            (steep**2 - flat**2) * cosine * sine,
            steep**2 * sine**2 + flat**2 * cosine**2,
        ],
        np.float32,
    ).reshape(1, 3, 1, 7)
    both = np.concatenate([tensor, 16 * tensor])
    assert weighted_strength(both, np.float32([1, 0])) == pytest.approx(np.full((1, 7), 0.3), rel=1e-5)
    assert weighted_strength(both, np.float32([1, 2])) == pytest.approx(np.full((1, 7), 0.3 + 2 * 0.6), rel=1e-5)
    seen = np.full((6, 8), 0.7, np.float32)
    both, flat = border_tensors(seen), np.zeros((8, 6, 8), np.float32)
    weights = np.float32([2, 3])
    strength = 2 * 0.7 + 3 * 0.7**2
    assert weighted_strength(both, weights) == pytest.approx(np.full((6, 8), strength), rel=1e-5)
    for labels in (np.indices((6, 8))[1] // 4, np.indices((6, 8))[0] // 3):
        regions = measure_regions(labels.astype(np.int32), flat[:3], flat, both, weights)
        assert regions.strengths / regions.pairs == pytest.approx([strength], rel=1e-5)


SHAPE = 14, 17
NONE_SEEN = np.empty((0, TERMS + 2))
WEIGHTS = np.array([1.0, 0.6, 1.4, 0.2, 0.3, -0.2])


def planes(seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return colours, roughness whose shares sum to 1, and the tensors of two cues."""
    rng = np.random.default_rng(seed)
    rough = rng.random((4, *SHAPE)).astype(np.float32)
    gradients = rng.random((2, 2, *SHAPE)).astype(np.float32)
    across, down = gradients[:, 0], gradients[:, 1]
    tensors = np.stack([across * across, across * down, down * down], axis=1)
    return rng.random((3, *SHAPE)).astype(np.float32), rough / rough.sum(axis=0), tensors


def blocks(rows: int = 3, columns: int = 4) -> np.ndarray:
    at = np.indices(SHAPE)
    return (at[0] * rows // SHAPE[0] * columns + at[1] * columns // SHAPE[1]).astype(np.int32)


def measured(labels: np.ndarray, seed: int = 0, weights: tuple[float, ...] = (1.0, 0.5)) -> Regions:
    return measure_regions(labels, *planes(seed), np.float32(weights))


class TestMeasuring:
    def test_sums_are_those_of_the_cells(self):
        labels, (colours, rough, _) = blocks(), planes()
        regions = measured(labels)
        for region in range(12):
            inside = labels == region
            assert regions.areas[region] == inside.sum()
            assert regions.colours[region] == pytest.approx(colours[:, inside].sum(axis=1))
            assert regions.roughness[region] == pytest.approx(rough[:, inside].sum(axis=1))

    @pytest.mark.parametrize("upright", [True, False])
    def test_change_along_a_border_does_not_count(self, upright: bool):
        labels = blocks(1, 2) if upright else blocks(2, 1)
        colours, rough, tensors = planes()
        along = np.zeros_like(tensors)
        along[:, 2 if upright else 0] = 0.7
        across = np.zeros_like(tensors)
        across[:, 0 if upright else 2] = 0.0081
        still, crossed = (measure_regions(labels, colours, rough, each, np.float32([1, 2])) for each in (along, across))
        assert still.strengths.tolist() == [0]
        assert crossed.strengths / crossed.pairs == pytest.approx([3 * 0.3], rel=1e-5)


class TestJoining:
    @pytest.mark.parametrize("seed", range(4))
    def test_order_and_costs_are_those_of_measuring_anew(self, seed: int):
        labels = blocks()
        regions = measured(labels, seed)
        joins, costs = join_regions(regions, WEIGHTS, -2.0, NONE_SEEN)[:2]
        expected = joined_anew(regions, WEIGHTS, -2.0)
        assert [sorted(each) for each in joins.tolist()] == [list(each) for each, _ in expected]
        assert costs == pytest.approx([cost for _, cost in expected], rel=1e-6)


def joined_anew(regions: Regions, weights: np.ndarray, constant: float) -> list[tuple[tuple[int, ...], float]]:
    """Join the cheapest pair, with every sum computed again from the smallest regions."""
    held = {region: [region] for region in range(len(regions.areas))}
    result: list[tuple[tuple[int, ...], float]] = []
    while len(held) > 1:
        costs = {
            (one, other): cost
            for one, other in combinations(sorted(held), 2)
            if (cost := cost_anew(regions, held[one], held[other], weights, constant)) is not None
        }
        best = min(costs, key=costs.__getitem__)
        held[len(regions.areas) + len(result)] = held.pop(best[0]) + held.pop(best[1])
        result.append((best, costs[best]))
    return result


def cost_anew(regions: Regions, one: list[int], other: list[int], weights: np.ndarray, constant: float) -> float | None:
    between = [
        at for at, ends in enumerate(regions.borders.tolist()) if (ends[0] in one) != (ends[1] in one)
        and (ends[0] in other) != (ends[1] in other) and set(ends) <= {*one, *other}
    ]  # fmt: skip
    if not between:
        return None
    areas = [regions.areas[each].sum() for each in (one, other)]
    colours, rough = (
        [planes[each].sum(axis=0) / area for each, area in zip((one, other), areas, strict=True)]
        for planes in (regions.colours, regions.roughness)
    )
    total, pairs = regions.areas.sum(), regions.pairs[between].sum()
    terms = [
        regions.strengths[between].sum() / pairs,
        sqrt(max(0, 1 - np.sqrt(rough[0] * rough[1]).sum())),
        sqrt(np.hypot(*(colours[0] - colours[1])[1:])),
        log(min(areas) / total),
        log(max(areas) / total),
        log(pairs / sqrt(total)),
    ]
    return float(np.dot(weights, terms) + constant)
