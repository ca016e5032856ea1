"""Measures of segments, against values worked out by hand and against the definitions themselves."""

from itertools import combinations, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from benchmarks.regions import covering, rand_index
from tangible_bench.metrics.segments import (
    adjusted_rand_index,
    border_points,
    boundary_distance,
    contingency,
    matched_accuracy,
    segment_errors,
)
from tangible_core.errors import PictureError

SMALL = arrays.arrays(np.int32, st.just((3, 4)), elements=st.integers(0, 3))


def row(*labels: int) -> np.ndarray:
    return np.array([labels], np.int32)


def halves(edge: int, shape: tuple[int, int] = (20, 32)) -> np.ndarray:
    return np.broadcast_to(np.arange(shape[1]) >= edge, shape).astype(np.int32)


@pytest.mark.parametrize(
    ("labels", "truth", "expected"),
    [
        ([0, 0, 1, 1], [1, 1, 0, 0], 1),
        ([0, 0, 1, 2], [0, 0, 1, 1], 4 / 7),
        ([0, 0, 1, 1], [0, 1, 0, 1], -0.5),
        ([0, 0, 0, 0], [0, 1, 2, 3], 0),
        ([0, 0, 0, 0], [0, 0, 1, 1], 0),
        ([5, 5, 5], [-2, -2, -2], 1),  # one segment and one segment
        ([0, 1, 2], [2, 0, 1], 1),  # every pixel is one, in both
        ([7], [3], 1),
    ],
)
def test_adjusted_rand_index_equals_values_computed_by_hand(labels, truth, expected):
    assert adjusted_rand_index(contingency(row(*labels), row(*truth))) == expected


@given(SMALL, SMALL)
def test_adjusted_rand_index_counts_pairs(labels, truth):
    pairs = list(combinations(range(labels.size), 2))
    one, other = ([each.flat[i] == each.flat[j] for i, j in pairs] for each in (labels, truth))
    both, first, second = np.sum(np.logical_and(one, other)), sum(one), sum(other)
    chance = first * second / len(pairs)
    found = adjusted_rand_index(contingency(labels, truth))
    assert rand_index(contingency(labels, truth)) == pytest.approx(np.mean(np.equal(one, other)))
    if first == second == len(pairs) or first == second == 0:
        assert found == 1
    else:
        assert found == pytest.approx((both - chance) / ((first + second) / 2 - chance), abs=1e-12)
    size = 10**8  # products of such counts do not fit 64 bits
    assert adjusted_rand_index(np.array([[size, 0], [0, size]])) == 1
    assert adjusted_rand_index(np.array([[size, size], [size, size]])) == pytest.approx(-1 / (4 * size - 2), rel=1e-12)


@pytest.mark.parametrize(
    ("labels", "truth", "expected"),
    [
        (row(0, 0, 1, 1), row(1, 1, 0, 0), 1.0),
        (row(0, 0, 0, 0), row(0, 0, 0, 1), (3 * 3 / 4 + 1 * 1 / 4) / 4),
        (row(0, 0, 0, 1), row(0, 0, 0, 0), 3 / 4),
        (row(0, 1, 1, 1), row(0, 0, 1, 1), (2 * 1 / 2 + 2 * 2 / 3) / 4),
    ],
)
def test_covering_equals_values_computed_by_hand(labels, truth, expected):
    assert covering(contingency(labels, truth)) == pytest.approx(expected)


@given(SMALL, SMALL)
def test_accuracy_equals_the_best_of_all_matchings(labels, truth):
    best = max(np.mean(np.take(order, labels) == truth) for order in permutations(range(4)))
    assert matched_accuracy(contingency(labels, truth)) == pytest.approx(best)


def test_boundary_distance_of_an_extra_border_counts_in_one_direction():
    """The extra points are 6 px from the true border; those of the true border are at 0. A moved one is off by that."""
    assert [boundary_distance(halves(16 + shift), halves(16)) for shift in (1, 2, 7)] == [1, 2, 7]
    extra = halves(16) + halves(22)
    assert boundary_distance(extra, halves(16)) == pytest.approx((6 / 2 + 0) / 2)
    assert boundary_distance(halves(16), extra) == pytest.approx((0 + 6 / 2) / 2)


@given(SMALL, SMALL)
def test_boundary_distance_equals_the_mean_over_pairs_of_points(labels, truth):
    one, other = (np.argwhere(border_points(each)) / 2 for each in (labels, truth))
    if len(one) and len(other):
        apart = np.hypot(*np.moveaxis(one[:, None] - other[None], 2, 0))
        expected = (apart.min(axis=1).mean() + apart.min(axis=0).mean()) / 2
    else:
        expected = 5 if len(one) or len(other) else 0
    assert boundary_distance(labels, truth) == pytest.approx(expected, rel=1e-6)


def test_boundary_distance_without_borders_is_zero_or_the_diagonal():
    flat = np.zeros((3, 4), np.int32)
    assert segment_errors(flat, flat) == {"ari": 1, "accuracy": 1, "boundary_px": 0, "segments": 1}
    found = segment_errors(flat, halves(2, (3, 4)))
    assert found == {"ari": 0, "accuracy": 0.5, "boundary_px": 5, "segments": 1}


@pytest.mark.usefixtures("unchecked_shapes")
def test_maps_empty_or_of_different_size_are_refused():
    with pytest.raises(PictureError, match=r"\(3, 4\) and the true ones \(3, 5\)"):
        segment_errors(np.zeros((3, 4), np.int32), np.zeros((3, 5), np.int32))
    with pytest.raises(PictureError, match=r"\(0, 5\)"):
        segment_errors(np.zeros((0, 5), np.int32), np.zeros((0, 5), np.int32))
