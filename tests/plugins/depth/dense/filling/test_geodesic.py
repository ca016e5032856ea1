"""Geodesic candidates at the left border."""

import numpy as np
import pytest

from tangible_depth.dense.filling.eight_directions import fill_from_eight_directions
from tangible_depth.dense.filling.four_directions import fill_from_four_directions
from tangible_depth.dense.filling.geodesic import geodesic_candidates
from tangible_depth.dense.span import UNKNOWN


def corner() -> tuple[np.ndarray, np.ndarray]:
    """A dark wall, known above alone, that goes on at the left border below a near, light cloth that widens."""
    grey = np.full((30, 40), 20, np.uint8)
    disparity = np.full(grey.shape, np.int16(64))
    for y in range(6, 30):
        grey[y, max(4, 14 - y // 2) :] = 200
        disparity[y, max(4, 14 - y // 2) :] = 320
    disparity[:, :14] = UNKNOWN
    disparity[:6, 8:] = 64
    return disparity, grey


def test_path_follows_the_surface_around_a_corner():
    disparity, grey = corner()
    found = geodesic_candidates(disparity, grey)
    wall = (grey == 20)[:, :14] & (np.arange(14) < found.first[:, None])
    assert (found.values[:, :14][wall] == 64).all()
    assert found.lengths[20, 2] == 15  # as many steps as there are rows to row 5, some of them slanting


def test_path_length_is_its_steps_and_grey_changes():
    disparity = np.array([[UNKNOWN, UNKNOWN, UNKNOWN, 80, 80]], np.int16)
    found = geodesic_candidates(disparity, np.array([[10, 40, 35, 35, 0]], np.uint8))
    assert found.first.tolist() == [3]
    assert found.values[:, :3].tolist() == [[80, 80, 80]]
    assert found.lengths[:, :3].tolist() == [[3 + 35, 2 + 5, 1]]


def test_of_ways_of_equal_length_the_straight_one_is_taken():
    disparity = np.array([[UNKNOWN, 16], [UNKNOWN, 32], [UNKNOWN, 48]], np.int16)
    assert geodesic_candidates(disparity, np.zeros((3, 2), np.uint8)).values[:, 0].tolist() == [16, 32, 48]


def test_paths_avoid_rows_without_matches_and_other_gaps():
    disparity = np.full((3, 6), UNKNOWN)
    disparity[0, 2:], disparity[2, 3] = 48, 96
    found = geodesic_candidates(disparity, np.zeros((3, 6), np.uint8))
    assert found.first.tolist() == [2, 0, 3]
    assert (found.values[0, :2] == 48).all()
    assert (found.values[2, :3] == 96).all()
    assert (geodesic_candidates(np.full((3, 6), UNKNOWN), np.zeros((3, 6), np.uint8)).values == UNKNOWN).all()


@pytest.mark.parametrize("filled", [fill_from_four_directions, fill_from_eight_directions])
def test_left_border_takes_the_surface_of_its_grey(filled):
    disparity, grey = corner()
    found = filled(disparity, grey)
    assert (found[:, :4][grey[:, :4] == 20] == 64).all()
