import numpy as np
import pytest

from tangible_depth.rectify.epipolar import (
    epipoles,
    lines_in_left,
    sampson_distance,
    segments,
)
from tangible_depth.rectify.fundamental import eight_point
from two_cameras import seen_points

RECTIFIED = np.array([[0, 0, 0], [0, 0, -1], [0, 1.0, 0]])
"""left^T F right = y_right - y_left."""


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def test_lines_of_a_rectified_pair_are_its_rows():
    points = np.array([[3.0, 7.0], [100.0, 2.0]])
    for lines in (lines_in_left(RECTIFIED, points), lines_in_left(RECTIFIED.T, points)):
        lines *= np.sign(lines[:, 1:2])
        assert lines == pytest.approx(np.array([[0, 1, -7], [0, 1, -2.0]]))


def test_distances_in_a_rectified_pair_are_its_row_offsets():
    left, right = np.array([[10.0, 5], [40, 9]]), np.array([[2.0, 8], [30, 9]])
    assert sampson_distance(RECTIFIED, left, right) == pytest.approx([3 / np.sqrt(2), 0])


def test_distances_are_those_of_points_from_their_lines():
    random = np.random.default_rng(0)
    matrix = random.normal(size=(3, 3))
    left, right = random.normal(size=(2, 50, 2))
    to_left = np.einsum("ni,ni->n", lines_in_left(matrix, right), np.column_stack([left, np.ones(50)]))
    to_right = np.einsum("ni,ni->n", lines_in_left(matrix.T, left), np.column_stack([right, np.ones(50)]))
    # Both share the numerator: 1 / sampson^2 = 1 / d_left^2 + 1 / d_right^2.
    assert sampson_distance(matrix, left, right) ** -2 == pytest.approx(to_left**-2 + to_right**-2)


def test_sampson_distance_is_that_to_the_nearest_exact_pair():
    left, right = seen_points(count=20)
    matrix = eight_point(left, right)
    step = 1e-4 * np.random.default_rng(0).normal(size=(4, 20))
    normal = np.vstack([lines_in_left(matrix, right).T[:2], lines_in_left(matrix.T, left).T[:2]])
    in_left, in_right = line_length(matrix, right), line_length(matrix.T, left)
    gradient = normal * [in_left, in_left, in_right, in_right]
    expected = np.abs((step * gradient).sum(axis=0)) / np.linalg.norm(gradient, axis=0)
    assert sampson_distance(matrix, left + step[:2].T, right + step[2:].T) == pytest.approx(
        expected, rel=1e-2, abs=1e-8
    )


def line_length(matrix, points):
    return np.linalg.norm((np.column_stack([points, np.ones(len(points))]) @ matrix.T)[:, :2], axis=1)


def test_epipoles_of_known_cameras_are_exact():
    # P_left = [I | 0], P_right = [I | t]: right = left + t / depth, F = [t]x up to the convention's transpose.
    move = np.array([0.3, -0.2, 0.5])
    left, right = epipoles(skew(move))
    for epipole in (left, right):
        assert np.cross(epipole, move) == pytest.approx(np.zeros(3), abs=1e-12)


def test_epipole_has_no_line():
    assert np.isnan(lines_in_left(skew([2.0, 3.0, 1.0]), np.array([[2.0, 3.0]]))).all()


def test_segments_end_at_the_border_of_the_picture():
    lines = np.array([[0, 1.0, -4], [1, 0, -9], [1, -1, 0], [0, 1, 5]])
    found = segments(lines, (10, 20))
    expected = np.array([[0, 4, 19, 4], [9, 0, 9, 9], [0, 0, 9, 9], [np.nan] * 4])
    swapped = found[:, [2, 3, 0, 1]]
    same = np.isclose(found, expected, equal_nan=True).all(axis=1)
    assert (same | np.isclose(swapped, expected, equal_nan=True).all(axis=1)).all()


def test_distances_without_matches_are_empty():
    assert sampson_distance(RECTIFIED, np.empty((0, 2)), np.empty((0, 2))).shape == (0,)
