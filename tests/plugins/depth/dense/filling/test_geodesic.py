"""Ways round corners at the left border."""

import numpy as np
import pytest

from tangible_depth.dense.filling.eight_directions import fill_from_eight_directions
from tangible_depth.dense.filling.four_directions import fill_from_four_directions
from tangible_depth.dense.filling.geodesic import detours
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


def test_a_way_follows_the_surface_round_the_corner():
    disparity, grey = corner()
    found = detours(disparity, grey)
    wall = (grey == 20)[:, :14] & (np.arange(14) < found.first[:, None])
    assert (found.values[:, :14][wall] == 64).all()
    assert found.lengths[20, 2] == 15  # as many steps as there are rows to row 5, some of them slanting


def test_a_way_costs_its_steps_and_what_the_grey_changes_by():
    disparity = np.array([[UNKNOWN, UNKNOWN, UNKNOWN, 80, 80]], np.int16)
    found = detours(disparity, np.array([[10, 40, 35, 35, 0]], np.uint8))
    assert found.first.tolist() == [3]
    assert found.values[:, :3].tolist() == [[80, 80, 80]]
    assert found.lengths[:, :3].tolist() == [[3 + 35, 2 + 5, 1]]


def test_no_way_leads_through_rows_without_a_match_nor_through_other_gaps():
    disparity = np.full((3, 6), UNKNOWN)
    disparity[0, 2:], disparity[2, 3] = 48, 96
    found = detours(disparity, np.zeros((3, 6), np.uint8))
    assert found.first.tolist() == [2, 0, 3]
    assert (found.values[0, :2] == 48).all()
    assert (found.values[2, :3] == 96).all()
    assert (detours(np.full((3, 6), UNKNOWN), np.zeros((3, 6), np.uint8)).values == UNKNOWN).all()


@pytest.mark.parametrize("filled", [fill_from_four_directions, fill_from_eight_directions])
def test_the_left_border_is_filled_with_the_surface_that_the_picture_shows_there(filled):
    disparity, grey = corner()
    found = filled(disparity, grey)
    assert (found[:, :4][grey[:, :4] == 20] == 64).all()
