"""Pairs of 8 bits, whatever the pictures were."""

import numpy as np
import pytest

from tangible_core.data import Views
from tangible_depth.search.pairs import Pair, grey_pair


@pytest.mark.parametrize("factor", [2, 3])
@pytest.mark.parametrize("shape", [(8, 12), (7, 11), (1, 5), (9, 2)])
def test_smaller_pair_has_means_with_the_edge_repeated(factor: int, shape: tuple[int, int]):
    left, right = np.random.default_rng(0).integers(0, 256, (2, *shape), np.uint8)
    found = Pair.of(left, right).downsample(factor)
    for one, other in zip(found, (left, right), strict=True):
        whole = np.pad(other, [(0, -side % factor) for side in shape], mode="edge").astype(float)
        means = whole.reshape(len(whole) // factor, factor, -1, factor).mean(axis=(1, 3))
        assert np.abs(one - means).max() <= 0.5


def test_exchanged_pair_has_the_same_disparity():
    """A place is at 3 in the left view and at 1 in the right one; mirrored in five columns, at 3 in the first."""
    left, right = np.zeros((2, 1, 5), np.uint8)
    left[0, 3] = right[0, 1] = 9
    found = Pair.of(left, right).exchange()
    assert (found.left.tolist(), found.right.tolist()) == ([[0, 0, 0, 9, 0]], [[0, 9, 0, 0, 0]])
    assert found.left.flags.c_contiguous


def test_both_views_are_brightened_alike_by_a_power_of_two():
    """The left one reaches a third of white, the right one a ninth: both are doubled."""
    left, right = np.array([[0.0, 1 / 3]]), np.array([[1 / 9, 0.0]])
    found = grey_pair(Views(left, right), "test")
    assert found.left.tolist() == [[0, 170]]
    assert found.right.tolist() == [[57, 0]]


def test_negative_values_are_lifted_to_black():
    found = grey_pair(Views(np.array([[-0.5, 0.5]]), np.array([[-0.25, 0.25]])), "test")
    assert found.left.tolist() == [[0, 255]]
    assert found.right.tolist() == [[64, 191]]
