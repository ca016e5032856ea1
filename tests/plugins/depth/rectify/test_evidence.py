"""What counts as evidence for a rectification, at its bounds."""

import numpy as np
import pytest

from tangible_depth.rectify import rectifying_rotation as module
from tangible_depth.rectify.rectifying_rotation import threshold_px, unique_matches, verified_range
from tangible_depth.sparse.matches import Matches


def test_parts_of_a_picture_are_quarters_of_its_sides():
    """A point in the middle of each part, and points on the border, which belong to the last parts."""
    x, y = np.meshgrid(np.arange(4) * 200 + 100, np.arange(4) * 50 + 25)
    points = np.column_stack([x.ravel(), y.ravel()]).astype(float)
    assert module._count_parts(points, (200, 800)) == 16
    assert module._count_parts(points[:6], (200, 800)) == 6
    assert module._count_parts(np.array([[0, 0], [799, 0], [800, 0], [0, 200], [799, 199.5]]), (200, 800)) == 4


@pytest.mark.parametrize(
    ("shape", "expected"), [((600, 800), 1), ((1500, 1000), 1), ((3000, 6000), 4), ((6000, 30), 4)]
)
def test_inliers_lie_within_a_pixel_or_a_share_of_the_longer_side(shape: tuple[int, int], expected: float):
    assert threshold_px(shape) == expected


def test_equal_matches_count_once_and_keep_their_order():
    left = np.array([[5, 1], [2, 2], [5, 1], [2, 2], [0, 9], [5, 1.0]])
    right = np.array([[4, 1], [1, 2], [4, 1], [0, 2], [0, 9], [4, 1.0]])
    found = unique_matches(Matches(left, right))
    assert found.left_px.tolist() == [[5, 1], [2, 2], [2, 2], [0, 9]]
    assert found.right_px.tolist() == [[4, 1], [1, 2], [0, 2], [0, 9]]


def test_range_of_verified_matches_is_rounded_outwards():
    points = np.random.default_rng(0).uniform(0, 100, (50, 2))
    assert verified_range(points, np.full(50, 10.5)) == (10, 11)
    assert verified_range(points, np.full(50, -10.5)) == (-11, -10)


@pytest.mark.parametrize(("alike", "high"), [(4, 10), (5, 41)])
def test_match_needs_four_others_that_are_like_it(alike: int, high: int):
    """Groups of nine close matches: in each of ten, `alike` ones lie at 40 px, and the others at 0, 10, ... px."""
    random = np.random.default_rng(0)
    points = np.concatenate([at + random.uniform(0, 1, (9, 2)) for at in random.uniform(0, 9000, (60, 2))])
    disparity = np.tile(np.full(9, 9.5), (60, 1))
    disparity[:10] = 1000 * np.arange(9)
    disparity[:10, :alike] = 40.5
    assert verified_range(points, disparity.ravel()) == (9, high)
