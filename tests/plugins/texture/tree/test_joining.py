"""Small regions, their borders, and the order in which they are joined: against one that starts anew each time."""

from itertools import combinations
from math import log, sqrt

import numpy as np
import pytest

from tangible_texture.tree.joining import TERMS, join_regions
from tangible_texture.tree.regions import Regions, measure_regions, small_regions

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


class TestSmallRegions:
    def test_basins_meet_on_the_crest(self):
        strength = np.abs(np.arange(21, dtype=np.float32) - 10)[None].repeat(9, axis=0)
        strength = 10 - np.abs(strength - 0)  # a crest in the middle
        labels = small_regions(strength)
        assert labels.max() == 1
        assert np.array_equal(labels[:, :10], np.full((9, 10), labels[0, 0]))
        assert np.array_equal(labels[:, 11:], np.full((9, 10), labels[0, -1]))

    @pytest.mark.parametrize("shape", [(1, 1), (1, 9), (2, 2), (8, 9)])
    def test_even_strength_is_one_region(self, shape: tuple[int, int]):
        assert not small_regions(np.full(shape, 0.3, np.float32)).any()


class TestMeasuring:
    def test_sums_are_those_of_the_cells(self):
        labels, (colours, rough, _) = blocks(), planes()
        regions = measured(labels)
        for region in range(12):
            inside = labels == region
            assert regions.areas[region] == inside.sum()
            assert regions.colours[region] == pytest.approx(colours[:, inside].sum(axis=1))
            assert regions.roughness[region] == pytest.approx(rough[:, inside].sum(axis=1))

    def test_border_has_a_pair_for_each_side_that_two_regions_share(self):
        regions = measured(blocks(1, 2))
        assert regions.borders.tolist() == [[0, 1]]
        assert regions.pairs.tolist() == [SHAPE[0]]

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

    def test_strength_of_a_slanted_border_is_that_across_it(self):
        rows, columns = np.indices(SHAPE)
        labels = (rows + columns > 15).astype(np.int32)
        colours, rough, tensors = planes()
        tensors[:, 0], tensors[:, 1], tensors[:, 2] = 0.5, 0.5, 0.5  # steepest where rows and columns rise
        rising = measure_regions(labels, colours, rough, tensors, np.float32([1, 0]))
        tensors[:, 1] = -0.5
        falling = measure_regions(labels, colours, rough, tensors, np.float32([1, 0]))
        assert rising.strengths / rising.pairs == pytest.approx([1], abs=0.02)
        assert falling.strengths < 0.3 * rising.strengths


class TestJoining:
    @pytest.mark.parametrize("seed", range(4))
    def test_order_and_costs_are_those_of_measuring_anew(self, seed: int):
        labels = blocks()
        regions = measured(labels, seed)
        joins, costs = join_regions(regions, WEIGHTS, -2.0, NONE_SEEN)[:2]
        expected = joined_anew(regions, WEIGHTS, -2.0)
        assert [sorted(each) for each in joins.tolist()] == [list(each) for each, _ in expected]
        assert costs == pytest.approx([cost for _, cost in expected], rel=1e-6)

    def test_one_region_has_no_joining(self):
        regions = measured(np.zeros(SHAPE, np.int32))
        joins, costs, rows = join_regions(regions, WEIGHTS, 0.0, NONE_SEEN)
        assert (joins.shape, costs.shape, rows) == ((0, 2), (0,), 0)

    def test_every_measured_border_is_seen_with_its_terms(self):
        regions = measured(blocks(1, 3))
        seen = np.empty((10, TERMS + 2))
        joins, costs, rows = join_regions(regions, WEIGHTS, 0.5, seen)
        assert rows == 3
        assert seen[:3, :2].tolist() in ([[0, 1], [1, 2], [3, 2]], [[0, 1], [1, 2], [3, 0]])
        assert seen[2, 2:] @ WEIGHTS + 0.5 == pytest.approx(costs[1])
        assert join_regions(regions, WEIGHTS, 0.5, seen[:2])[2] == 2
        assert joins[1].tolist() == seen[2, :2].astype(int).tolist()

    def test_regions_are_not_changed(self):
        regions = measured(blocks())
        before = [each.copy() for each in regions]
        join_regions(regions, WEIGHTS, 0.0, NONE_SEEN)
        assert all(np.array_equal(one, other) for one, other in zip(before, regions, strict=True))


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
